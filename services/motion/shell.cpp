// SPDX-License-Identifier: Apache-2.0
#include "motion/shell.hpp"

#include <algorithm>
#include <cstdio>

#include "contract/config_error.hpp"
#include "motion/codec.hpp"

namespace stillhand::motion {

Shell::Shell(runtime::Service& service, const std::filesystem::path& ride)
    : service_(service),
      config_(service.config<MotionGenerator::Config>()),
      core_(config_),
      command_(service.bus().publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand)) {
  if (!ride.empty()) ride_ = read_ride(ride.string());
  service.on_trial([this](const Trial&, const auto&) { prepare_when_complete(); });
  service.bus().subscribe<stillhand_msgs::TrialAssignment>(
      topics::kTrialAssignment, [this](const auto& message, const auto&) {
        assignment_ = message;
        prepare_when_complete();
      });
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message.tick()); });
}

// Control and assignment come in either order.
void Shell::prepare_when_complete() {
  const Trial trial = service_.trial();
  if (!assignment_ || trial.number < 0 || assignment_->trial() != trial.number ||
      prepared_trial_ == trial.number) {
    return;
  }
  prepared_trial_ = trial.number;
  MotionProfile profile = from_idl(*assignment_, trial);
  if (profile.kind == MotionKind::kRide) {
    profile.ride_rate_hz = ride_.rate_hz;
    profile.ride_accel_m_s2 = ride_.accel_m_s2;
  }
  handover_.prepare([this, profile = std::move(profile), trial]() -> std::unique_ptr<Prepared> {
    try {
      return std::make_unique<Prepared>(Prepared{MotionTrajectory(profile, config_.limits), trial});
    } catch (const ConfigError& error) {
      service_.note_event(stillhand_msgs::EVENT_NOTE, error.what());
      return nullptr;  // the platform stands still and the trial is never armed
    }
  });
}

void Shell::tell_what_was_removed(const MotionProfile& profile, const MotionReport& report) {
  if (profile.kind != MotionKind::kRide) return;
  char text[128];
  std::snprintf(text, sizeof(text),
                "ride high-passed at %.3f Hz to stay in the workspace: %.1f %% of its variance "
                "removed, RMS %.2f m/s^2 left",
                report.corner_hz, 100.0 * report.removed_share, report.rms_m_s2);
  service_.note_event(stillhand_msgs::EVENT_NOTE, text);
}

void Shell::on_sensed(Tick tick) {
  if (Prepared* newest = handover_.current(); newest != nullptr && newest != armed_) {
    armed_ = newest;
    core_.arm(newest->trajectory, newest->trial);
    service_.note_armed(newest->trial.number);
  }
  // Lost sensed samples leave a gap here; the rig needs every command, within reason.
  const Tick first = std::max(last_ + 1, tick + 1);
  for (Tick next = first; next <= tick + kLead; ++next) {
    auto message = to_idl(core_.step(next), next, armed_ == nullptr ? -1 : armed_->trial.number);
    command_.write(message);
    last_ = next;
  }
  service_.note_tick(tick);
}

}  // namespace stillhand::motion
