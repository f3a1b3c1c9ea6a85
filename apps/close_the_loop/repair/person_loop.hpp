// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/human_operator/crossover_config.hpp"
#include "services/core/rig/parts/body_config.hpp"

namespace stillhand::close_the_loop {

/// What a session's recordings say of the person who tracks, METHOD Eq. CL-12.
struct PersonModel {
  cancellation::HandCompliance hand;    ///< stick and arm to a force at the hand
  human_operator::CrossoverConfig who;  ///< who.arm is the same hand
};

/// What is given in a trial, at 1 kHz.
struct Course {
  std::int64_t first_tick = 0;
  std::vector<cancellation::ChannelSample> sensed;  ///< theta and omega are not used
  std::vector<double> target_m;
  std::vector<double> force_n;  ///< feedthrough, without what no model explains
};

/// What the stick's drive does beyond a mass.
struct Drive {
  double friction_n = rig::StickConfig{}.coulomb_friction_n;
  double late_s = 0.0;                     ///< [s] the motor beyond what is declared
  std::vector<cancellation::Wave> ripple;  ///< force on the stick, in theta
};

/// One simulated trial: the person's model of force, hand and operator around the cores of
/// canceller, motor, display and operator, METHOD Eq. CL-11.
/// @param canceller    null: the motor is off
/// @param unexplained  [N] at 1 kHz: the hand's own force; begins at a place that the seed chooses
/// @return RMS tracking error [mm] after the first 2 s
/// @throws ConfigError when the canceller refuses the model
double tracking_error_mm(const PersonModel& person, const Course& course, const Drive& drive,
                         const cancellation::ControlModel* canceller,
                         const std::vector<double>& unexplained, std::uint64_t seed);

}  // namespace stillhand::close_the_loop
