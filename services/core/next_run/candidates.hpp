// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::next_run {

/// A cause that explains a recording about as well as another one.
struct Candidate {
  diagnosis::Model model;     ///< fitted to the recording, with every other effect of the verdict
  std::size_t effect = 0;     ///< in `model.effects`: the one that the candidates do not share
  double heldout_rmse = 0.0;  ///< [unit of the output] as the search judged it
  [[nodiscard]] const diagnosis::Effect& cause() const { return model.effects.at(effect); }
};

/// At most so many, the verdict's included: the pairs grow with the square.
inline constexpr std::size_t kMostCandidates = 5;

/// Candidates of one effect of the verdict, the verdict's own first, Eq. NR-1: one for each kind
/// and channel.  Fewer than two: no other cause is close.  Pure.
/// @param signals  of the recording, as it was diagnosed
std::vector<Candidate> candidates_of(const diagnosis::Diagnosis& diagnosis, std::size_t effect,
                                     const diagnosis::Signals& signals);

/// What else than the platform's motion separates two candidates, Eq. NR-8, a sentence each;
/// empty: they read the same channels.
std::vector<std::string> other_ways(const Candidate& one, const Candidate& other,
                                    const diagnosis::Signals& signals);

/// "coulomb_friction (of omega, sign)"
std::string name_of(const Candidate& candidate);

}  // namespace stillhand::next_run
