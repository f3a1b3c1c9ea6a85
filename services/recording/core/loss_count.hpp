// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "services/contract/tick.hpp"

namespace stillhand::recording {

/// What one writer sent and what came of it, Eq. RC-11.  Two numberings are compared: the sequence
/// number that DDS gave each sample, and the tick that the sample itself carries.  A sample missing
/// by either is lost; one missing by its tick alone never reached the writer's DDS, so the loss was
/// before the bus.  Pure; one thread.
class LossCount {
 public:
  /// @param sequence  DDS's, counted by the writer  @param tick  the sample's own, -1: it has none
  void step(std::int64_t sequence, Tick tick) noexcept {
    ++received_;
    const std::int64_t by_sequence = started_ ? sequence - sequence_ - 1 : 0;
    // A tick that goes back is another session of the same writer.
    const std::int64_t by_tick = tick >= 0 && tick_ >= 0 ? tick - tick_ - 1 : 0;
    const std::int64_t on_the_way = std::max<std::int64_t>(by_sequence, 0);
    const std::int64_t before = std::max<std::int64_t>(by_tick - on_the_way, 0);
    lost_ += on_the_way + before;
    not_sent_ += before;
    sequence_ = started_ ? std::max(sequence, sequence_) : sequence;
    started_ = true;
    if (tick >= 0) tick_ = tick;
  }

  [[nodiscard]] std::int64_t received() const noexcept { return received_; }
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_; }
  /// Of these, missing by their tick alone.
  [[nodiscard]] std::int64_t not_sent() const noexcept { return not_sent_; }

 private:
  std::int64_t received_ = 0, lost_ = 0, not_sent_ = 0, sequence_ = 0;
  Tick tick_ = -1;
  bool started_ = false;
};

}  // namespace stillhand::recording
