// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>

/// Names of the conditions.  A study keeps its results by a single character: A to F are their own
/// letters (session::Condition), and C' and C+, which only recorded sessions have, have codes of
/// their own.
namespace stillhand::study {

inline constexpr char kFollowing = 'c';  ///< C': the session's model, which follows the hand
inline constexpr char kAugmented = 'p';  ///< C+: an augmented model

/// Steps from one canceller to the next, compared where both were run.
inline constexpr std::array<std::pair<char, char>, 3> kCancellerSteps{
    {{'C', kFollowing}, {kFollowing, kAugmented}, {'C', kAugmented}}};

/// "A" to "F", "C'", "C+".
inline std::string condition_word(char condition) {
  if (condition == kFollowing) return "C'";
  if (condition == kAugmented) return "C+";
  return std::string(1, condition);
}

/// The condition of a word of condition_word().
inline char condition_of(const std::string& word) {
  if (word == "C'") return kFollowing;
  if (word == "C+") return kAugmented;
  return word.front();
}

/// Whether the motor cancels.
inline bool cancels(char condition) {
  return condition == 'C' || condition == kFollowing || condition == kAugmented;
}

/// "C'-C+"
inline std::string pair_word(char from, char to) {
  return condition_word(from) + "-" + condition_word(to);
}

}  // namespace stillhand::study
