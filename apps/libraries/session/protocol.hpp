// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/libraries/session/core/conditions.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/motion/motion_profile.hpp"

namespace stillhand::session {

/// The numbers of a session, from the command line; defaults are the paper's unless said otherwise.
struct ProtocolOptions {
  std::vector<Condition> conditions;
  double trial_s = 180.0;    ///< [s] measured length of a tracking trial; paper III-C
  double identify_s = 40.0;  ///< [s] pegged trial; the paper's is 120 s (III-A)
  bool planned = false;      ///< the pegged trial alone, in the motion of a ride
  double ramp_s = 2.0;       ///< [s] motion and target fade in and out
  std::uint64_t seed = 1;    ///< of everything random
  motion::MotionKind motion = motion::MotionKind::kBandNoise;  ///< of B and C: noise, road, ride
  std::string road_class = "B";  ///< MotionKind::kRoad: ISO 8608, A (very good) to H
  double road_speed_m_s = 20.0;  ///< [m/s] MotionKind::kRoad: speed of the vehicle
  /// [s] period of both multisines of P, which then is the one trial after the pegged one; 0: none
  double perturb_period_s = 0.0;
  bool perturb_swapped = false;  ///< P: the platform takes the lines of the motor, and the reverse
  bool stick_held = false;       ///< P: on the peg, without the motor
  /// Values of the two arms of `scheduled`, relaxed and holding; without them it has none.
  std::vector<double> arms = {};
};

/// One trial of the session: the part that every process may know, and the part that stays blinded.
struct PlannedTrial {
  Trial trial;                   ///< start_tick is set when it runs
  std::uint64_t reference_seed;  ///< phases of the target
  Condition label;               ///< or an identification: blinded
  bool moving;
  motion::MotionKind motion = motion::MotionKind::kBandNoise;  ///< multisine: interleaved, of P
  double band_low_hz, band_high_hz;                            ///< [Hz]
  int band_order;              ///< roll-off of the noise at each edge; 0: abrupt
  double rms_m_s2, peak_m_s2;  ///< [m/s^2]
  std::uint64_t motion_seed;
  bool cancellation;
  bool command_filter;  ///< in process only
  std::vector<cancellation::Part>
      parts;  ///< of a mitigation in place of cancellation; over the bus
};

/// By cancellation or by another mitigation.
bool drives_motor(const PlannedTrial& planned);
/// A prediction of the feedthrough alone drives the motor.
bool opposes_feedthrough(const PlannedTrial& planned);

/// For CLI11: the error in the word of a --seed, or an empty text.  (CLI11 itself would take a
/// number that is too large for the largest one.)
std::string check_seed(const std::string& word);

/// "A,B,C" or "A,B,signal" to conditions; `none` is B, and `force` is C.
/// @throws ConfigError for one that does not run there, a repeated or a missing one.
std::vector<Condition> parse_conditions(const std::string& text, Where where = kLabConditions,
                                        const char* option = "--conditions");
/// "A (stationary), B (moving), ..., notch, ...": what parse_conditions() takes.
std::string known_conditions(Where where);

/// Identification first, with the stick pegged and, where a condition needs it, free; then the
/// conditions in an order shuffled by the seed; every seed of a trial follows from the session's.
/// @throws ConfigError for durations out of range (5 s to 3600 s), a road class that ISO 8608 does
///         not define, or a speed out of range (0.5 to 70 m/s).
std::vector<PlannedTrial> plan(const ProtocolOptions& options);

/// The pegged trial, number 0, which gives the session its model.
PlannedTrial identification_trial(const ProtocolOptions& options);
/// Its repetition, in the same motion with other phases.
PlannedTrial identification_again(const ProtocolOptions& options, std::int64_t number);
/// The one with the stick free, in the same motion with other phases: it gives the feedthrough to
/// position.
PlannedTrial free_identification_trial(const ProtocolOptions& options, std::int64_t number);
/// One tracking trial of a condition.
/// @param number  of the trial in its session, from 1; its seeds follow from it and the session's
PlannedTrial tracking_trial(const ProtocolOptions& options, Condition condition,
                            std::int64_t number);

/// Seed of a session that repeats one with other draws.
std::uint64_t repeat_seed(std::uint64_t seed, std::uint64_t repeat);

/// Motion that a planned trial asks of the platform; the caller adds the data of a road or ride.
motion::MotionProfile motion_profile(const PlannedTrial& planned);

}  // namespace stillhand::session
