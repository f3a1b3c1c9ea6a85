// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/contract/trial.hpp"
#include "services/mitigation/core/part.hpp"
#include "services/motion/core/motion_profile.hpp"

namespace stillhand::session {

/// A to C are the conditions of the paper, section III-C.  D to F, all with the motor off, are the
/// alternatives that its section V proposes to compare with the motor.
enum class Condition : char {
  kStationary = 'A',       ///< platform still, motor off
  kMoving = 'B',           ///< platform moves, motor off
  kMovingCancelled = 'C',  ///< platform moves, motor cancels
  kCommandFilter = 'D',    ///< platform moves, the prediction is taken off the command
  kDampedStick = 'E',      ///< platform moves, more stick damping
  kArmRest = 'F',          ///< platform moves, the forearm rests
  kPerturbed = 'P',        ///< platform and motor move the hand at once, to identify it
  // Mitigations that a session over the bus runs too, live_mitigation.hpp; the platform moves.
  kLowPass = 'l',
  kNotch = 'n',
  kModelFilter = 'm',
  kSignal = 's',
  kLmsSignal = 'u',
  kAdaptive = 'a',
  kScheduled = 'h',
  kLmsForce = 'v',
  kDamping = 'd',
  kImpedance = 'i',
  kDampingForce = 'f',
};

/// Label of the pegged trial that gives the session its model.
inline constexpr char kIdentification = 'I';
/// Label of the trial with a free stick that gives it the feedthrough to position, where a
/// condition needs it.
inline constexpr char kFreeIdentification = 'J';

/// Conditions of a session over the bus, and of a study.
inline constexpr const char* kLabConditions = "ABC";
inline constexpr const char* kStudyConditions = "ABCDEF";

/// Kind of platform motion during B and C; kInterleaved during P.
enum class Motion : std::uint8_t { kBandNoise, kRoad, kRide, kInterleaved };

/// The numbers of a session, from the command line; defaults are the paper's unless said otherwise.
struct ProtocolOptions {
  std::vector<Condition> conditions;
  double trial_s = 180.0;    ///< [s] measured length of a tracking trial; paper III-C
  double identify_s = 40.0;  ///< [s] pegged trial; the paper's is 120 s (III-A)
  double ramp_s = 2.0;       ///< [s] motion and target fade in and out
  std::uint64_t seed = 1;    ///< of everything random
  Motion motion = Motion::kBandNoise;
  std::string road_class = "B";  ///< Motion::kRoad: ISO 8608, A (very good) to H
  double road_speed_m_s = 20.0;  ///< [m/s] Motion::kRoad: speed of the vehicle
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
  char label;                    ///< 'I' identification, or the condition: blinded
  bool moving;
  Motion motion;
  double band_low_hz, band_high_hz;  ///< [Hz]
  int band_order;                    ///< roll-off of the noise at each edge; 0: abrupt
  double rms_m_s2, peak_m_s2;        ///< [m/s^2]
  std::uint64_t motion_seed;
  bool cancellation;
  bool command_filter;                  ///< in process only
  std::vector<mitigation::Part> parts;  ///< of a mitigation in place of cancellation; over the bus
};

/// For CLI11: the error in the word of a --seed, or an empty text.  (CLI11 itself would take a
/// number that is too large for the largest one.)
std::string check_seed(const std::string& word);

/// Name in reports.
const char* condition_name(Condition condition);

/// Whether a list of conditions may name mitigations too.
enum class Named : std::uint8_t { kLettersAlone, kMitigationsToo };

/// "A,B,C" or "A,B,signal" to conditions; `none` is B, and `force` is C.
/// @param allowed  their letters
/// @throws ConfigError for an unknown, repeated or missing one.
std::vector<Condition> parse_conditions(const std::string& text,
                                        const std::string& allowed = kLabConditions,
                                        Named named = Named::kLettersAlone);

/// Identification first, with the stick pegged and, where a condition needs it, free; then the
/// conditions in an order shuffled by the seed; every seed of a trial follows from the session's.
/// @throws ConfigError for durations out of range (5 s to 3600 s), a road class that ISO 8608 does
///         not define, or a speed out of range (0.5 to 70 m/s).
std::vector<PlannedTrial> plan(const ProtocolOptions& options);

/// The pegged trial, number 0.
PlannedTrial identification_trial(const ProtocolOptions& options);
/// The one with the stick free, in the same motion with other phases.
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
