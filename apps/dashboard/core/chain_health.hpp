// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "apps/dashboard/core/log_histogram.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/time_difference.hpp"

namespace stillhand::dashboard {

/// From the acquisition of a sample to the step of the rig that first uses its answer, Eq. DB-5.
/// Every time is a difference of stamps that the messages carry, so any listener that lost nothing
/// has the same, in whatever order the topics reach it.  Pure, no allocation; one thread.
class ChainHealth {
 public:
  /// A message of `sensed`.  @param acquired_ns  [ns] the rig's clock  @param stamp_ns  [ns] its
  /// writer's clock, brought to the rig's
  void sensed(std::int64_t acquired_ns, std::int64_t stamp_ns) noexcept {
    sensed_.add(difference_ns(stamp_ns, acquired_ns));
  }
  /// A message of `motor_command`; times as above.
  void command(Tick tick, std::int64_t acquired_ns, std::int64_t stamp_ns) noexcept {
    command_.add(difference_ns(stamp_ns, acquired_ns));
    if (tick < 0) return;
    Slot& slot = slot_of(tick);
    slot.acquired_ns = acquired_ns;
    complete(slot);
  }
  /// A message of `rig_truth`.  @param motor_tick  tick that the motor command in use answers, -1
  /// none  @param stamp_ns  [ns] the rig's clock
  void used(Tick motor_tick, std::int64_t stamp_ns) noexcept {
    if (motor_tick < 0 || motor_tick == newest_used_) return;
    newest_used_ = motor_tick;
    Slot& slot = slot_of(motor_tick);
    slot.used_ns = stamp_ns;
    complete(slot);
  }
  /// Another session.
  void clear() noexcept { *this = {}; }

  [[nodiscard]] Spread to_sensed() const noexcept { return sensed_.spread(); }
  [[nodiscard]] Spread to_command() const noexcept { return command_.spread(); }
  [[nodiscard]] Spread to_motor() const noexcept { return motor_.spread(); }
  /// [ns] of the newest answer that was used, 0 none; taken by the reading.
  std::int64_t take_worst_ns() noexcept {
    const std::int64_t worst_ns = worst_ns_;
    worst_ns_ = 0;
    return worst_ns;
  }

 private:
  struct Slot {
    Tick tick = -1;
    std::int64_t acquired_ns = 0, used_ns = 0;
  };
  static constexpr std::size_t kSlots = 1024;  // 1 s: more than any answer waits

  Slot& slot_of(Tick tick) noexcept {
    Slot& slot = slots_[static_cast<std::size_t>(tick) % kSlots];
    if (slot.tick != tick) slot = {tick, 0, 0};
    return slot;
  }
  void complete(Slot& slot) noexcept {
    if (slot.acquired_ns == 0 || slot.used_ns == 0) return;
    const std::int64_t whole_ns = difference_ns(slot.used_ns, slot.acquired_ns);
    motor_.add(whole_ns);
    worst_ns_ = std::max(worst_ns_, whole_ns);
    slot = {};
  }

  std::array<Slot, kSlots> slots_{};
  Tick newest_used_ = -1;
  std::int64_t worst_ns_ = 0;
  LogHistogram sensed_, command_, motor_;
};

}  // namespace stillhand::dashboard
