// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "services/bus/found_writer.hpp"
#include "services/bus/recording/tape.hpp"
#include "services/core/recording/loss_count.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// One topic of a recording, all its writers together.
struct TopicTally {
  std::uint64_t writers = 0, received = 0, lost = 0, not_sent = 0, written = 0;
  std::uint64_t late = 0;  ///< sent later after the one before than the writer's offered deadline
  bool type_known = true;  ///< its definition is
};

/// Passes samples from the bus to the tape: makes a channel for each writer at its first sample and
/// counts its samples.  The threads of DDS call take(); any thread may call the other functions.
class Tally {
 public:
  /// @param tape  not nullptr; first used by take()
  explicit Tally(Tape* tape) : tape_(tape) {}

  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);

  /// A sequence number without a sample, of a writer that ended an instance.
  void end_instance(std::size_t writer, std::int64_t sequence);

  /// Counts by topic; a wanted writer that sent nothing has zeros.
  [[nodiscard]] std::map<std::string, TopicTally> topics(
      const std::vector<runtime::FoundWriter>& found) const;
  /// Topics with at least one sample.
  [[nodiscard]] std::set<std::string> heard() const;
  /// The counts as metadata record "stillhand.counts" of a file.
  [[nodiscard]] TextMap texts() const;

 private:
  struct Source {
    std::string topic;
    std::uint32_t channel = 0;
    bool has_ticks = false;
    LossCount count;
    std::uint64_t late = 0;
    std::int64_t sequence = 0, sent_ns = 0;  // of the newest sample
  };

  Tape* tape_;
  mutable std::mutex mutex_;
  std::map<std::size_t, Source> sources_;  // by the writer's number
};

}  // namespace stillhand::recording
