// SPDX-License-Identifier: Apache-2.0
#include "services/processes/motion/shell.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "services/messages/motion/codec.hpp"

namespace stillhand::motion {

Shell::Shell(runtime::Service& service, RideAndRoad way)
    : service_(service),
      config_(service.config<MotionGenerator::Config>()),
      core_(config_),
      way_(std::move(way)),
      ride_(way_.ride.empty() ? RideRecord{} : read_ride(way_.ride.string())),
      command_(service.bus().publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand)),
      trial_(
          service,
          [this](const auto& assignment, const auto& trial) { return plan(assignment, trial); },
          [this](const Trial& trial) { core_.announce(trial); }) {
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message.tick()); });
}

AssignedTrial<Shell::Prepared>::Make Shell::plan(const stillhand_msgs::TrialAssignment& assignment,
                                                 const Trial& trial) {
  MotionProfile profile = from_idl(assignment, trial);
  complete(profile);
  return [this, profile = std::move(profile), trial] {
    auto prepared =
        std::make_unique<Prepared>(Prepared{MotionTrajectory(profile, config_.limits), trial});
    report_motion(profile, prepared->trajectory.report());
    return prepared;
  };
}

// What the assignment leaves open.
void Shell::complete(MotionProfile& profile) const {
  profile.road_class = way_.road_class;
  profile.road_speed_m_s = way_.road_speed_m_s;
  if (profile.kind == MotionKind::kMultisine && way_.perturbation.period_s != 0.0) {
    profile.components = admittance::motion_components(way_.perturbation, profile.duration_ticks);
  }
  if (profile.kind != MotionKind::kRide) return;
  profile.ride_rate_hz = ride_.rate_hz;
  profile.ride_accel_m_s2 = ride_.accel_m_s2;
}

// Into the recording: neither the ride nor the road is on the bus.
void Shell::report_motion(const MotionProfile& profile, const MotionReport& report) const {
  char text[128];
  if (profile.kind == MotionKind::kRide) {
    std::snprintf(text, sizeof(text),
                  "ride: high-pass at %.3f Hz, %.1f %% of its variance removed (%.1f %% by the "
                  "high-pass), RMS %.3f m/s^2 left",
                  report.corner_hz, 100.0 * report.removed_share, 100.0 * report.removed_slow_share,
                  report.rms_m_s2);
  } else if (profile.kind == MotionKind::kRoad) {
    std::snprintf(text, sizeof(text), "road: class %s at %.1f m/s, RMS %.3f m/s^2",
                  profile.road_class.c_str(), profile.road_speed_m_s, report.rms_m_s2);
  } else if (profile.kind == MotionKind::kMultisine && way_.perturbation.period_s != 0.0) {
    std::snprintf(text, sizeof(text), "%s", admittance::in_words(way_.perturbation).c_str());
  } else {
    return;
  }
  service_.note_event(stillhand_msgs::EVENT_NOTE, text);
}

void Shell::on_sensed(Tick tick) {
  if (Prepared* newest = trial_.newly_armed()) {
    core_.arm(std::move(newest->trajectory), newest->trial);
  }
  // Lost sensed samples leave a gap here; the rig needs every command, within reason.
  const Tick first = std::max(last_ + 1, tick + 1);
  for (Tick next = first; next <= tick + kLead; ++next) {
    auto message = to_idl(core_.step(next), next, trial_.armed());
    command_.write(message);
    last_ = next;
  }
  service_.note_tick(tick);
}

}  // namespace stillhand::motion
