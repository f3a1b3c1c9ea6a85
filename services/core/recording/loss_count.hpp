// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "services/core/contract/tick.hpp"

namespace stillhand::recording {

/// Counts the received and lost samples of one writer.  It compares two numbers of each sample: the
/// sequence number of DDS and the tick inside the sample.  A sample is lost if either number is
/// missing.  If only the tick is missing, the sample never reached the writer's DDS and was lost
/// before the bus.  The end of an instance has a number too, and no sample.  Source: README Eq.
/// RC-11.  Pure; one thread.
class LossCount {
 public:
  /// @param sequence  sequence number of DDS, counted by the writer
  /// @param tick      tick of the sample, -1: none
  void step(std::int64_t sequence, Tick tick) noexcept {
    ++received_;
    // A decreasing tick means another session of the same writer.
    const std::int64_t by_tick = tick >= 0 && tick_ >= 0 ? tick - tick_ - 1 : 0;
    const std::int64_t on_the_way = missing_before(sequence);
    const std::int64_t before = std::max<std::int64_t>(by_tick - on_the_way, 0);
    add(lost_, on_the_way + before);
    add(not_sent_, before);
    advance(sequence);
    if (tick >= 0) tick_ = tick;
  }

  /// The writer disposed of an instance or gave one up.
  void end_instance(std::int64_t sequence) noexcept {
    add(lost_, missing_before(sequence));
    advance(sequence);
  }

  [[nodiscard]] std::int64_t received() const noexcept { return received_; }
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_; }
  /// Lost samples of which only the tick is missing.
  [[nodiscard]] std::int64_t not_sent() const noexcept { return not_sent_; }

 private:
  [[nodiscard]] std::int64_t missing_before(std::int64_t sequence) const noexcept {
    return started_ ? std::max<std::int64_t>(sequence - sequence_ - 1, 0) : 0;
  }
  void advance(std::int64_t sequence) noexcept {
    sequence_ = started_ ? std::max(sequence, sequence_) : sequence;
    started_ = true;
  }
  // Ticks come from the bus or a file: a sum stays at its limit instead of overflowing.
  static void add(std::int64_t& sum, std::int64_t count) noexcept {
    if (__builtin_add_overflow(sum, count, &sum)) sum = INT64_MAX;
  }

  std::int64_t received_ = 0, lost_ = 0, not_sent_ = 0, sequence_ = 0;
  Tick tick_ = -1;
  bool started_ = false;
};

}  // namespace stillhand::recording
