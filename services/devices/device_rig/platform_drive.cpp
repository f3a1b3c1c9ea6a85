// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/platform_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillhand::device_rig {
namespace {

// A platform stands that stayed within a millimetre for so long: our own choice.
constexpr Tick kStands_ticks = 100;
constexpr double kStands_m = 0.001;

}  // namespace

const char* text_of(SeatReason reason) noexcept {
  // In the order of SeatReason.
  constexpr std::array kTexts{"",
                              "the platform is silent",
                              "the platform reports a fault",
                              "the platform stopped following by itself",
                              "the platform follows another program",
                              "the platform was not engaged when the trial began",
                              "the platform stands outside of its travel"};
  static_assert(kTexts.size() == static_cast<std::size_t>(SeatReason::kOutside) + 1);
  return kTexts[static_cast<std::size_t>(reason)];
}

double PlatformDrive::within_travel(double position_m) const noexcept {
  return std::clamp(position_m, -limits_.guard.max_position_m, limits_.guard.max_position_m);
}

bool PlatformDrive::asks_to_follow() const noexcept {
  return stage_ == SeatStage::kEngaging || stage_ == SeatStage::kFollowing ||
         stage_ == SeatStage::kBraking;
}

PlatformDrive::Output PlatformDrive::step(const Input& input) noexcept {
  const bool was_fresh = fresh_;
  fresh_ = input.age_ticks <=
           (asks_to_follow() ? limits_.most_following_age_ticks : limits_.most_age_ticks);
  look_whether_it_stands(input);
  moved_in_silence_ = fresh_ && !was_fresh && stands_ticks_ == 0;
  switch (stage_) {
    case SeatStage::kAbsent:
    case SeatStage::kStanding:
      return idle(input);
    case SeatStage::kEngaging:
    case SeatStage::kFollowing:
      return driven(input);
    case SeatStage::kBraking:
      return braking(input);
    case SeatStage::kFaulted:
      break;
  }
  return faulted(input);
}

void PlatformDrive::look_whether_it_stands(const Input& input) noexcept {
  const bool there = fresh_ && std::abs(input.reply.position_m - stood_m_) <= kStands_m;
  stands_ticks_ = there ? stands_ticks_ + 1 : 0;
  if (!there) stood_m_ = input.reply.position_m;
}

SeatReason PlatformDrive::trouble(const Input& input) const noexcept {
  if (!fresh_) return SeatReason::kSilent;
  if (input.reply.stage == PlatformStage::kFault) return SeatReason::kFault;
  if (input.stranger) return SeatReason::kStranger;
  if (confirmed_ && input.reply.stage != PlatformStage::kFollowing) return SeatReason::kOff;
  return SeatReason::kNone;
}

PlatformDrive::Output PlatformDrive::fail(const Input& input, SeatReason reason) noexcept {
  stage_ = SeatStage::kFaulted;
  reason_ = reason;
  fault_ = reason == SeatReason::kFault ? input.reply.fault : 0;
  blocked_trial_ = input.trial;
  return faulted(input);
}

// METHOD Eq. DR-22: what was asked for before is forgotten.
PlatformDrive::Output PlatformDrive::faulted(const Input& input) noexcept {
  confirmed_ = held_ = false;
  const bool quiet = fresh_ && input.reply.stage != PlatformStage::kFault && !input.stranger;
  if (quiet && input.trial != blocked_trial_) {
    stage_ = SeatStage::kStanding;
    reason_ = SeatReason::kNone;
    return idle(input);
  }
  return {stage_, {.order = PlatformOrder::kRelease}, kInhibited};
}

PlatformDrive::Output PlatformDrive::hold(const Input& input) noexcept {
  // Taken once: a platform that stays engaged would creep after its own report.  And again where
  // somebody else moved it in a silence: it must not jump back.
  if (fresh_ && (!held_ || moved_in_silence_)) hold_m_ = input.reply.position_m;
  if (fresh_) held_ = input.reply.stage == PlatformStage::kFollowing;
  if (!fresh_ && !held_) return {stage_, {.order = PlatformOrder::kRelease}, kInhibited};
  return {stage_, {.order = PlatformOrder::kHold, .position_m = hold_m_}, kInhibited};
}

PlatformDrive::Output PlatformDrive::idle(const Input& input) noexcept {
  stage_ = fresh_ ? SeatStage::kStanding : SeatStage::kAbsent;
  confirmed_ = false;
  if (input.leave == MotionLeave::kHold || input.trial == blocked_trial_) return hold(input);
  const SeatReason reason = trouble(input);
  if (reason != SeatReason::kNone && reason != SeatReason::kSilent) return fail(input, reason);
  if (input.leave == MotionLeave::kFollow) {
    return fail(input, fresh_ ? SeatReason::kLate : SeatReason::kSilent);
  }
  if (stands_ticks_ < kStands_ticks) return hold(input);
  if (std::abs(input.reply.position_m) > limits_.guard.max_position_m) {
    return fail(input, SeatReason::kOutside);
  }
  stage_ = SeatStage::kEngaging;
  held_ = false;
  return await_confirmation(input);
}

// A machine that rises takes its time; what it does then is its own.
PlatformDrive::Output PlatformDrive::await_confirmation(const Input& input) noexcept {
  const double place_m = input.reply.position_m;
  if (std::abs(place_m) > limits_.guard.max_position_m) return fail(input, SeatReason::kOutside);
  guard_.stand_at(place_m);
  return {stage_, {.order = PlatformOrder::kFollow, .position_m = place_m}, kInhibited};
}

PlatformDrive::Output PlatformDrive::ask(const motion::GuardInput& wanted) noexcept {
  const motion::PlatformCommand next = guard_.step(wanted);
  return {stage_,
          {.order = PlatformOrder::kFollow,
           .position_m = next.position_m,
           .velocity_m_s = next.velocity_m_s,
           .acceleration_m_s2 = next.acceleration_m_s2},
          next.flags};
}

PlatformDrive::Output PlatformDrive::driven(const Input& input) noexcept {
  if (const SeatReason reason = trouble(input); reason != SeatReason::kNone) {
    return fail(input, reason);
  }
  if (input.leave == MotionLeave::kHold) {
    stage_ = SeatStage::kBraking;
    return braking(input);
  }
  const bool late =
      confirmed_ ? input.measured && !way_.over() : input.leave == MotionLeave::kFollow;
  if (late) return fail(input, SeatReason::kLate);
  bool began = false;
  if (!confirmed_) {
    const bool follows = input.reply.stage == PlatformStage::kFollowing;
    const bool asked = input.wanted.valid && std::isfinite(input.wanted.command.position_m);
    Output waits = await_confirmation(input);
    if (!follows || !asked || stage_ != SeatStage::kEngaging) return waits;
    confirmed_ = began = true;
    way_.begin(input.reply.position_m - within_travel(input.wanted.command.position_m));
  }
  motion::GuardInput wanted = input.wanted;
  if (wanted.valid && !way_.over()) {
    const auto offset = way_.step();
    wanted.command.position_m = within_travel(wanted.command.position_m) + offset.position_m;
    wanted.command.velocity_m_s += offset.velocity_m_s;
    wanted.command.acceleration_m_s2 += offset.acceleration_m_s2;
  }
  stage_ = way_.over() ? SeatStage::kFollowing : SeatStage::kEngaging;
  Output output = ask(wanted);
  output.began = began;
  return output;
}

PlatformDrive::Output PlatformDrive::braking(const Input& input) noexcept {
  if (const SeatReason reason = trouble(input); reason != SeatReason::kNone) {
    return fail(input, reason);
  }
  if (!confirmed_ || guard_.state().velocity_m_s == 0.0) {
    stage_ = SeatStage::kStanding;
    hold_m_ = guard_.state().position_m;
    held_ = confirmed_;
    confirmed_ = false;
    return hold(input);
  }
  Output output = ask({});
  output.flags = kInhibited;
  return output;
}

}  // namespace stillhand::device_rig
