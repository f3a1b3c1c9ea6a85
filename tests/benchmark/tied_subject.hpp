// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "tests/planted/recording.hpp"

/// Bodies with a known effect that can be measured again in another motion.
namespace stillhand::benchmark {

struct TiedSubject {
  std::string kind;     ///< that acts; "none"
  std::string variant;  ///< where or in which form
  diagnosis::Measurement measured;
  /// The same body and effect in a given motion, with other noise.
  std::function<diagnosis::Measurement(const motion::MotionTrajectory&)> again;
  /// The same in a motion like the first one.
  std::function<diagnosis::Measurement(double seconds)> repeated;
};

/// One of the planted recordings.
TiedSubject planted_subject(std::uint64_t seed, const planted::Spec& spec);

/// The simulated rig with the undeclared effect of a seed and the sensors of a session.
struct TiedRig {
  double seconds = 120.0;      ///< of the first recording
  double noise_n_rthz = 1e-3;  ///< of the load cell
  bool passive = false;        ///< an arm without forces and changes of its own, RG-27 to RG-32
};
TiedSubject rig_subject(std::uint64_t seed, const TiedRig& rig);

}  // namespace stillhand::benchmark
