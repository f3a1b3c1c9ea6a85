// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/rehearsal.hpp"

#include <fmt/format.h>

#include <optional>

#include "services/core/admittance/session_excitation.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/files/settings/load.hpp"

namespace stillhand::lab {
namespace {

motion::MotionProfile profile_of(const session::PlannedTrial& planned,
                                 const session::ProtocolOptions& options,
                                 const motion::RideRecord& ride) {
  motion::MotionProfile profile = session::motion_profile(planned);
  profile.road_class = options.road_class;
  profile.road_speed_m_s = options.road_speed_m_s;
  profile.ride_rate_hz = ride.rate_hz;
  profile.ride_accel_m_s2 = ride.accel_m_s2;
  if (planned.motion == motion::MotionKind::kMultisine) {
    profile.components = admittance::motion_components(
        {options.perturb_period_s, options.seed, options.perturb_swapped}, profile.duration_ticks);
  }
  return profile;
}

// What the user can change about a motion that the platform cannot follow.
ConfigError refusal(const session::PlannedTrial& planned, const session::ProtocolOptions& options,
                    const motion::RideRecord& ride, const std::string& why) {
  switch (planned.motion) {
    case motion::MotionKind::kBandNoise:
      return {"motion.yaml",
              fmt::format("the noise of trial {} ({})", planned.trial.number,
                          session::name_of(planned.label)),
              fmt::format("limits that allow it ({})", why)};
    case motion::MotionKind::kRoad:
      return {
          "--road-class",
          fmt::format("{} at {:.6g} m/s", options.road_class, options.road_speed_m_s),
          fmt::format("a better road or less speed, so that the platform can follow ({})", why)};
    case motion::MotionKind::kMultisine:
      return {"--trial-seconds and --perturb-period-s",
              fmt::format("{:.6g} and {:.6g}", options.trial_s, options.perturb_period_s),
              fmt::format("a motion that the platform can follow ({})", why)};
    case motion::MotionKind::kStill:
    case motion::MotionKind::kRide:
      break;
  }
  return {ride.source, "a ride that the platform cannot follow",
          fmt::format("another ride ({})", why)};
}

}  // namespace

AskedMotions rehearse(const std::vector<session::PlannedTrial>& trials,
                      const session::ProtocolOptions& options, const motion::RideRecord& ride,
                      const std::filesystem::path& config) {
  const auto platform =
      settings::load<motion::MotionGenerator::Config>(config / "motion.yaml", "motion");
  const auto screen =
      settings::load<display::TrackingDisplay::Config>(config / "display.yaml", "display");
  AskedMotions asked;
  std::optional<motion::MotionReport> followed_ride;
  for (const session::PlannedTrial& planned : trials) {
    const Trial& trial = planned.trial;
    if (trial.phase == TrialPhase::kTracking) {
      display::reference_on_screen(screen, trial.duration_ticks, planned.reference_seed);
    }
    if (!planned.moving) continue;
    // A ride has no seed, so every trial has the same motion; an hour of it takes seconds to make.
    if (planned.motion == motion::MotionKind::kRide && followed_ride) {
      asked[trial.number] = *followed_ride;
      continue;
    }
    try {
      const motion::MotionTrajectory motion(profile_of(planned, options, ride), platform.limits);
      asked[trial.number] = motion.report();
      if (planned.motion == motion::MotionKind::kRide) followed_ride = motion.report();
    } catch (const ConfigError& error) {
      throw refusal(planned, options, ride, error.what());
    }
  }
  return asked;
}

}  // namespace stillhand::lab
