// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/core/next_run/contest.hpp"

namespace stillhand::next_run {

/// Causes that the search could not tell from the one it named, and those that the whole recording
/// leaves of them: the one judgement of a tie, for every verb.  README Eq. NR-1 and NR-5.
struct Tie {
  std::size_t effect = 0;            ///< of the verdict
  std::vector<Candidate> close;      ///< the verdict's own first; two or more
  std::vector<Candidate> left = {};  ///< one: the recording decides

  [[nodiscard]] bool broken() const { return left.size() < 2; }
  /// "tied on this recording: A and B", or which of them it leaves.
  [[nodiscard]] std::string in_words() const;
};

/// One for each effect that other causes explain about as well, the strongest effect first.  Pure.
/// @param signals  of the recording, as it was diagnosed
/// @throws stillhand::ConfigError as Contest
std::vector<Tie> ties_of(const diagnosis::Diagnosis& diagnosis, const diagnosis::Signals& signals);

}  // namespace stillhand::next_run
