// SPDX-License-Identifier: Apache-2.0
// The platform's part of a DevicePlant.
#include <cstdio>
#include <limits>

#include "services/devices/device_rig/device_plant.hpp"

namespace stillhand::device_rig {

void DevicePlant::put_platform(rig::RigOutput& output) const noexcept {
  if (!platform_) return;
  const bool fresh = platform_fresh();
  if (parts_.acceleration == Parts::Source::kPlatform) {
    output.raw.accel_x_v = output.raw.accel_z_v = 0.0;
    output.raw.accel_y_v =
        fresh ? seat_.reply.acceleration_m_s2 : std::numeric_limits<double>::quiet_NaN();
  }
  output.truth.platform_position_m =
      fresh ? seat_.reply.position_m : std::numeric_limits<double>::quiet_NaN();
  output.truth.platform_acceleration_m_s2 =
      fresh ? seat_.reply.acceleration_m_s2 : std::numeric_limits<double>::quiet_NaN();
  if (!fresh) output.flags |= kInputStale;
}

// What the shell permits, and never beyond what the trial does: without one nothing moves.
MotionLeave DevicePlant::leave_of(const rig::RigInput& input) const noexcept {
  if (trial_.covers(tick_) || input.leave == MotionLeave::kHold) return input.leave;
  const bool comes =
      trial_.number >= 0 && trial_.phase != TrialPhase::kIdle && tick_ < trial_.start_tick;
  return comes ? MotionLeave::kEngage : MotionLeave::kHold;
}

PlatformDrive::Output DevicePlant::move_platform(const rig::RigInput& input, bool turn) noexcept {
  const Tick age_ticks =
      seat_.count > 0 ? (now_ns_ - seat_.at_ns) / 1'000'000 : PlatformDrive::kNever;
  const auto asked = seat_drive_.step(
      {.leave = leave_of(input),
       .measured = trial_.measures(tick_),
       .trial = trial_.number,
       .age_ticks = age_ticks,
       .reply = seat_.reply,
       .stranger = seat_.reply.owner != 0 && seat_.reply.owner != platform_->token(),
       .wanted = {.valid = input.command_valid,
                  .command = {.position_m = input.command_position_m,
                              .velocity_m_s = input.command_velocity_m_s,
                              .acceleration_m_s2 = input.command_acceleration_m_s2}}});
  if (asked.began) {
    std::snprintf(notice_text_.data(), notice_text_.size(),
                  "the platform engages: from %+.0f mm to the trial's place in %.1f s",
                  1e3 * seat_.reply.position_m, seat_drive_.way().length_s());
    notice_ = notice_text_.data();
  }
  // A release or a stop does not wait for the turn of an exchange.
  if (turn || asked.set_point.order != asked_order_) platform_->demand(asked.set_point);
  asked_order_ = asked.set_point.order;
  return asked;
}

// A platform that lost its permission stays unsound for the trial: METHOD Eq. DR-22.
void DevicePlant::judge_platform() noexcept {
  const bool lost = seat_drive_.stage() == SeatStage::kFaulted &&
                    seat_drive_.trial() == trial_.number && trial_.number >= 0;
  const std::uint32_t fault = lost ? seat_drive_.fault() : seat_.reply.fault;
  const bool reports = platform_fresh() && seat_.reply.stage == PlatformStage::kFault;
  if (lost ? seat_drive_.reason() == SeatReason::kFault : reports) {
    std::snprintf(platform_text_.data(), platform_text_.size(), "the platform reports fault 0x%x",
                  fault);
    why_ = platform_text_.data();
  } else if (lost) {
    why_ = text_of(seat_drive_.reason());
  } else if (!platform_fresh()) {
    why_ = text_of(SeatReason::kSilent);
  }
}

}  // namespace stillhand::device_rig
