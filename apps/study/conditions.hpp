// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>

#include "apps/session/live_mitigation.hpp"

/// Names of the conditions.  A study keeps its results by a single character: A to F and the
/// mitigations of a session are session::Condition, and C' and C+, which only recorded sessions
/// have, have codes of their own.
namespace stillhand::study {

inline constexpr char kFollowing = 'c';  ///< C': the session's model, which follows the hand
inline constexpr char kAugmented = 'p';  ///< C+: an augmented model

/// Steps from one canceller to the next, compared where both were run.
inline constexpr std::array<std::pair<char, char>, 3> kCancellerSteps{
    {{'C', kFollowing}, {kFollowing, kAugmented}, {'C', kAugmented}}};

/// "A" to "F", "C'", "C+", or a mitigation's name.
inline std::string condition_word(char condition) {
  if (condition == kFollowing) return "C'";
  if (condition == kAugmented) return "C+";
  return session::condition_label(condition);
}

/// The condition of a word of condition_word().
inline char condition_of(const std::string& word) {
  if (word == "C'") return kFollowing;
  if (word == "C+") return kAugmented;
  return word.size() == 1 ? word.front() : session::letter_of(word);
}

/// Whether it is a mitigation of a session, apps/session/live_mitigation.hpp.
inline bool is_mitigation(char condition) {
  return session::live_mitigation(static_cast<session::Condition>(condition)) != nullptr;
}

/// Whether the motor cancels, as in C.
inline bool cancels(char condition) {
  return condition == 'C' || condition == kFollowing || condition == kAugmented;
}

/// "C'-C+"
inline std::string pair_word(char from, char to) {
  return condition_word(from) + "-" + condition_word(to);
}

}  // namespace stillhand::study
