// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/study/mitigations/cases.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/core/population/population.hpp"

namespace stillhand::study {

/// What does not change from mitigation to mitigation: the same person, motion, target and noise.
struct TrialScene {
  population::Subject subject;  ///< as drawn
  TrialTask task = TrialTask::kTrack;
  motion::MotionTrajectory motion;  ///< without one the platform stands still
  std::int64_t number = 1;          ///< selects the stream of the remnant
  std::uint64_t rig_seed = 1;
  std::uint64_t reference_seed = 1;
  Tick duration_ticks = 60'000;
  Tick ramp_ticks = 2'000;
  Tick settle_ticks = 20'000;  ///< of the duration, before anything counts
};

/// Over the ticks that count.
struct TrialFigures {
  double error_mm = 0.0;  ///< RMS on the screen: of cursor to target, or of the cursor
  double motor_n = 0.0;   ///< RMS of the motor's force
  double effort_n = 0.0;  ///< RMS of the volitional force; 0 where the person only holds or relaxes
  double weight = 0.0;    ///< mean of w, Eq. MI-5
};

/// Runs one trial with a mitigation.
/// @param arm_rest  the forearm rests, as in condition F
/// @throws ConfigError as cancellation::Countermeasure and the cores do.
TrialFigures run_mitigated(const TrialScene& scene, const cancellation::Recipe& recipe,
                           bool arm_rest);

/// Motion of a trial.
/// @param seed  of its phases, and of the made ride
/// @throws ConfigError when the platform cannot make it
motion::MotionTrajectory trial_motion(TrialMotion motion, Tick duration_ticks, Tick ramp_ticks,
                                      std::uint64_t seed);

/// A made ride, METHOD Eq. SU-17: lateral acceleration [m/s^2] at 100 Hz of a vehicle that sways at
/// 1.4 Hz on a road whose roughness changes, and drives curves.  Own choice, no recording.
std::vector<double> made_ride(double length_s, std::uint64_t seed);
inline constexpr double kMadeRide_hz = 100.0;

}  // namespace stillhand::study
