// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "services/core/motion/motion_trajectory.hpp"
#include "services/core/next_run/contest.hpp"

namespace stillhand::next_run {

enum class Family : std::uint8_t { kNoise, kMultisine, kSweep, kSteps };

/// "band noise", "multisine", "sweep" or "loud and quiet".
std::string in_words(Family family);

/// A motion of the family, Eq. NR-9.
struct Design {
  Family family = Family::kNoise;
  double low_hz = 0.7;
  double high_hz = 4.0;
  double level = 1.0;  ///< [-] of the loudest motion of this kind within the limits
  double quiet = 1.0;  ///< [-] kSteps: of that, every second part of kPart_s
  std::uint64_t seed = 1;
};

/// [s] a loud or a quiet part.
inline constexpr double kPart_s = 5.0;

/// What the platform may be asked: the profile of a ride (band, peak, length, ramps), and limits.
struct Bounds {
  motion::MotionProfile ride;
  motion::PlatformLimits limits;
};

/// A design as a ride, and the motion that the platform makes of it.
struct Ride {
  static constexpr double kRate_hz = 100.0;
  std::vector<double> accel_m_s2;  ///< at kRate_hz, from the first measured tick, a ramp longer
  motion::MotionTrajectory motion;
};

/// @throws stillhand::ConfigError where the limits allow nothing of this kind
Ride ride_of(const Design& design, const Bounds& bounds);

/// The channels of a run in which the platform's acceleration is this motion.  The others go as
/// they went in the recording, from its longest stretch, over and over; the output is 0.
diagnosis::Measurement run_of(const motion::MotionTrajectory& motion,
                              const diagnosis::Measurement& recorded, const std::string& input,
                              const std::string& output);

/// [deviations] Least margin of a pair that a motion can settle: in 2 % of the runs, Eq. NR-10.
inline constexpr double kHopeless = -2.0;

/// The best of the designs, and what it can tell apart.
struct Plan {
  Design design;
  Ride ride;
  diagnosis::Measurement run;       ///< as run_of()
  Expected expected;                ///< Eq. NR-3, refitted
  Eigen::MatrixXd chance;           ///< Eq. NR-6
  double probability_settled = 0;   ///< Eq. NR-7
  double probability_repeated = 0;  ///< the same of the recorded motion, for as long
  Eigen::MatrixXd best_margin;      ///< of each pair, the largest of all designs, Eq. NR-10
  std::size_t tried = 0;            ///< designs

  /// No design separates the two, whichever is true, Eq. NR-12.
  [[nodiscard]] bool out_of_reach(Eigen::Index i, Eigen::Index j) const {
    return best_margin(i, j) < kHopeless && best_margin(j, i) < kHopeless;
  }
};

/// What a run of another length is expected to do, Eq. NR-12.
struct Lasting {
  double seconds = 0.0;
  double probability_settled = 0.0;
};

using ForEach = diagnosis::ForEach;

/// The motion on which the candidates differ most, Eq. NR-10, or the mildest of those that settle
/// nearly always, Eq. NR-11: a grid of families, bands and levels, then two rounds around the best.
/// Deterministic.
/// @throws stillhand::ConfigError where no design keeps the limits
Plan best_plan(const Contest& contest, const diagnosis::Measurement& recorded, const Bounds& bounds,
               const ForEach& for_each);

/// The plan's design for other lengths, Eq. NR-12.
/// @param bounds  as of best_plan()
std::vector<Lasting> longer(const Plan& plan, const std::vector<double>& seconds,
                            const Contest& contest, const diagnosis::Measurement& recorded,
                            const Bounds& bounds);

}  // namespace stillhand::next_run
