// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/arming.hpp"

#include <array>
#include <cstddef>

namespace stillhand::device_rig {

const char* text_of(Reason reason) noexcept {
  // In the order of Reason.
  constexpr std::array kTexts{"",
                              "the drive is silent",
                              "the drive's watchdog tripped",
                              "the drive reports a fault",
                              "the drive went off by itself",
                              "the drive is in a mode that Stillhand does not command",
                              "the drive does not follow",
                              "the drive was away or started again; its settings are not read back",
                              "the angle of the drive jumped"};
  static_assert(kTexts.size() == static_cast<std::size_t>(Reason::kEncoder) + 1);
  return kTexts[static_cast<std::size_t>(reason)];
}

Arming::Output Arming::step(const Input& input) noexcept {
  switch (stage_) {
    case Stage::kArmed:
      return armed(input);
    case Stage::kFaulted:
      return faulted(input);
    default:
      return idle(input);
  }
}

Reason Arming::trouble(const Input& input) const noexcept {
  if (!input.fresh) return Reason::kSilent;
  if (input.jumped) return Reason::kEncoder;
  if (input.mode == DriveMode::kFault) return Reason::kFault;
  if (input.mode == DriveMode::kTimedOut) return Reason::kTimedOut;
  if (!input.checked) return Reason::kUnchecked;
  if (confirmed_ && input.mode == DriveMode::kOff) return Reason::kOff;
  if (confirmed_ && input.mode != DriveMode::kTorque) return Reason::kOtherMode;
  if (!confirmed_ && since_ticks_ > kPatience_ticks) return Reason::kNotArmed;
  return Reason::kNone;
}

Arming::Output Arming::fail(const Input& input, Reason reason) noexcept {
  stage_ = Stage::kFaulted;
  reason_ = reason;
  fault_ = input.mode == DriveMode::kFault ? input.fault : 0;
  blocked_trial_ = input.trial;
  return {stage_, Order::kStop, reason_, false};
}

Arming::Output Arming::idle(const Input& input) noexcept {
  stage_ = !input.fresh ? Stage::kAbsent : input.checked ? Stage::kChecked : Stage::kFound;
  if (stage_ == Stage::kChecked && input.mode != DriveMode::kOff) {
    // Whatever it does, it was not asked to: driver off, which clears a latched timeout, too.
    return {stage_, Order::kStop, Reason::kNone, false};
  }
  const bool may = input.wanted && input.trial != blocked_trial_ && !input.jumped;
  if (stage_ != Stage::kChecked || !may || !input.force_zero)
    return {stage_, Order::kQuery, Reason::kNone, false};
  stage_ = Stage::kArmed;
  since_ticks_ = 0;
  confirmed_ = false;
  return {stage_, Order::kTorque, Reason::kNone, false};
}

Arming::Output Arming::armed(const Input& input) noexcept {
  ++since_ticks_;
  if (const Reason reason = trouble(input); reason != Reason::kNone) return fail(input, reason);
  confirmed_ = confirmed_ || input.mode == DriveMode::kTorque;
  // Without permission the force ramps down first, then the driver goes off.
  if (!input.wanted && input.force_zero) {
    stage_ = Stage::kChecked;
    return {stage_, Order::kStop, Reason::kNone, false};
  }
  return {stage_, Order::kTorque, Reason::kNone, confirmed_};
}

Arming::Output Arming::faulted(const Input& input) noexcept {
  const bool quiet = input.fresh && input.mode == DriveMode::kOff && !input.jumped;
  // Another trial, and a drive that is off and free of faults: it counts as found again.
  if (quiet && input.trial != blocked_trial_) {
    reason_ = Reason::kNone;
    return idle(input);
  }
  return {stage_, quiet ? Order::kQuery : Order::kStop, reason_, false};
}

}  // namespace stillhand::device_rig
