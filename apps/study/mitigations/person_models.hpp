// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "apps/study/mitigations/design.hpp"
#include "services/core/admittance/arm_model.hpp"
#include "services/core/identification/record.hpp"
#include "services/core/population/population.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::study {

/// Everything that a laboratory can identify of one person before the trials, and that a mitigation
/// may be made of.  All difference models at 1 kHz.
struct PersonModels {
  signal::DifferenceModel pegged;                ///< feedthrough to force, idle hand; paper III-A
  std::vector<signal::DifferenceModel> reduced;  ///< the same by order from 1 on
  signal::DifferenceModel position;  ///< feedthrough to position [s^2] of a free, held stick
  admittance::ArmValues relaxed{};   ///< fitted while relaxing, AD-12
  admittance::ArmValues holding{};   ///< the same while holding the position
  // For the models of several people at once; at 50 Hz, displacement in mm.
  identification::Record pegged_record;
  identification::Record position_record;
};

/// Orders of `reduced`; the last is the paper's, and that of `pegged`.
inline constexpr int kReducedOrders = 4;
/// Length of each of the two records of force and motion at once: eight periods of 20 s.
inline constexpr std::int64_t kAdmittancePeriods = 8;

/// Identifies a person, METHOD Eq. SU-16: pegged and idle; free and holding, both with the motion
/// of paper III-A; then force and motion at once (AD-1 to AD-15), relaxing and holding.
/// @param seed  of motions and of the rig's noise
/// @throws ConfigError when no usable model results.
PersonModels identify_person(const population::Subject& subject, double identify_s,
                             std::uint64_t seed);

/// Models of several people at once: for `pegged` one least-squares fit to all their records
/// (ID-18); for the others the least free-run error (ID-6) over the records one after another; and
/// the geometric means of their arms.
PersonModels average_models(const std::vector<PersonModels>& people);

/// What the choices over a population need of a person.
KnownPerson known(const PersonModels& models);

}  // namespace stillhand::study
