// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/recorded/recorded_trial.hpp"
#include "apps/study/recorded/registration.hpp"

/// Who and what of the recordings is in the tables.  Pure.
namespace stillhand::study {

/// All that the sessions of one participant give.
struct Person {
  std::string code;
  std::optional<Identification> identification;
  double identify_s = 0.0;
  std::int64_t broken_trials = 0;     ///< tracking trials that were ended early
  std::vector<RecordedTrial> trials;  ///< complete ones
};

/// Of each condition the mean over the complete trials counts, Eq. SU-14.  A person who lacks the
/// pegged trial, or a condition that more than half of the people have, is left out.
Selection select(const std::vector<Person>& people);

/// Applies the exclusion rules, Eq. SU-12: takes trials, then people away.
/// @returns one line for each: which, why, and the rule
std::vector<std::string> apply_rules(const Registration& registration, std::vector<Person>& people);

}  // namespace stillhand::study
