// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/study/recorded/diagnoses.hpp"

namespace stillhand::study {

/// @param have  people in whom the effect was found
/// @param able  people in whom it could have been found, those included
/// Pure.  METHOD Eq. SU-21.
Whose whose(std::size_t have, std::size_t able);

/// Chance that a newcomer's model lacks the effect, (have + 1)/(able + 2), Laplace's rule of
/// succession.
double newcomers_chance(const RecurringEffect& effect);

/// Share of the mean square force that the models of all people lack, by effects of one owner.
double share_of(const Diagnoses& diagnoses, Whose owner);

/// What the others forecast of a person who is left out, METHOD Eq. SU-22.
struct LeftOutPerson {
  std::string participant;
  std::size_t found = 0;       ///< effects that the person has
  std::size_t forecast = 0;    ///< of these, what the others forecast
  std::size_t false_ones = 0;  ///< forecast, and the person does not have them
};
std::vector<LeftOutPerson> leave_one_out(const std::map<std::string, PersonDiagnosis>& people);

}  // namespace stillhand::study
