// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/recording/tape.hpp"
#include "services/core/recording/topic_filter.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::record {

struct RecordOptions {
  recording::TapeOptions tape;
  recording::TopicFilter topics;
  std::vector<std::string> required;  ///< topics without which a trial is not worth starting
  bool trigger_on_deadline = false;   ///< a missed deadline writes the event window
  std::vector<std::filesystem::path>
      idl;                            ///< definitions of types that discovery does not describe
  std::vector<std::string> triggers;  ///< conditions that write it, as FieldTrigger reads them
  std::optional<std::int64_t> duration_ns;  ///< [ns] nothing: until a signal
  std::uint32_t domain = 0;
  std::filesystem::path profiles;
  std::filesystem::path security;  ///< see runtime::Bus::Options
};

/// Records until the duration is over, a signal arrives or the tape stops.  Prints the counts of
/// messages received, lost and written.  @returns 0, or 1 when anything was lost, missing or could
/// not be written
/// @throws ConfigError, runtime::BusError
int run_record(const RecordOptions& options, runtime::Stop& stop);

/// Sends one command to the recorders of a domain: "pause", "resume", "trigger" or "stop".
/// @returns 0 when one obeyed, 1 when none did or answered  @throws ConfigError for another word
int run_remote(const std::string& action, const RecordOptions& options, runtime::Stop& stop);

}  // namespace stillhand::record
