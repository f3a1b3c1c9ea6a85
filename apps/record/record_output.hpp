// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "services/bus/recording/bus_recording.hpp"
#include "services/bus/tap.hpp"

namespace stillhand::record {

/// One line on standard error, red on a terminal.
void warn(const std::string& line);

/// Warns of required topics that are silent, whenever that changes or a trial is announced.
class RequiredTopics {
 public:
  /// @param required  outlives this
  explicit RequiredTopics(const std::vector<std::string>& required) : required_(required) {}

  /// @param heard  topics that were heard  @param trial  newest trial announced, -1 none
  void step(const std::set<std::string>& heard, std::int64_t trial);
  /// Silent topics, comma-separated.
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }

 private:
  const std::vector<std::string>& required_;
  std::string missing_;
  std::string printed_;
  std::int64_t trial_ = -1;
};

/// The line that a terminal shows while the verb records; a pipe gets nothing.
void print_progress(const recording::TapeStatus& tape, std::uint64_t lost, std::int64_t elapsed_ns);

/// Counts of each topic on standard output, faults on standard error.
/// @returns true when nothing is missing
bool print_end(const recording::BusRecording& recorded, const runtime::Tap& tap,
               const recording::Status& closed, std::uint32_t domain);

}  // namespace stillhand::record
