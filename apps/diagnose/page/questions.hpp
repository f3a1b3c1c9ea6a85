// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::diagnose {

/// One question's answers by the two residuals.
struct Answers {
  diagnosis::Detection before;  ///< of the baseline's residual
  diagnosis::Detection after;   ///< of what the effects leave; share NaN: it wasn't asked again
};

/// The questions with the largest shares, before or after, at most `count`.
std::vector<Answers> strongest_answers(const diagnosis::Diagnosis& found, std::size_t count);

}  // namespace stillhand::diagnose
