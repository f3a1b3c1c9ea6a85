// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "services/recording/core/loss_count.hpp"
#include "services/recording/core/mcap/mcap_format.hpp"
#include "services/recording/tape.hpp"
#include "services/runtime/bus/found_writer.hpp"

namespace stillhand::recording {

/// One topic of a recording, all its writers together.
struct TopicTally {
  std::uint64_t writers = 0, received = 0, lost = 0, not_sent = 0, written = 0;
  bool type_known = true;
};

/// From the bus to the tape: makes a channel for each writer at its first sample and counts what
/// came of each.  take() is for DDS's threads, the rest for any.
class Tally {
 public:
  /// @param tape  not nullptr; not used before the first take()
  explicit Tally(Tape* tape) : tape_(tape) {}

  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);

  /// By topic; the wanted writers that sent nothing are there with zeros.
  [[nodiscard]] std::map<std::string, TopicTally> topics(
      const std::vector<runtime::FoundWriter>& found) const;
  /// Topics of which a sample came.
  [[nodiscard]] std::set<std::string> heard() const;
  /// The same counts as the metadata record "stillhand.counts" of a file.
  [[nodiscard]] TextMap texts() const;

 private:
  struct Source {
    std::string topic;
    std::uint32_t channel = 0;
    bool has_ticks = false;
    LossCount count;
  };

  Tape* tape_;
  mutable std::mutex mutex_;
  std::map<std::size_t, Source> sources_;  // by the writer's number
};

}  // namespace stillhand::recording
