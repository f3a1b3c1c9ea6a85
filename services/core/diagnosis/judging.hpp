// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/impulse_response.hpp"
#include "services/core/diagnosis/fitting/screening.hpp"

/// From the search's model to the verdict.
namespace stillhand::diagnosis {

/// What every residual of a recording is asked with.
struct Questions {
  explicit Questions(const Signals& signals);
  [[nodiscard]] auto of(const Screening& screening) const {
    return detected(screening, excitation);
  }

  ImpulseResponse impulse_response;
  std::optional<PeriodicExcitation> excitation;
};

/// The model that the search found, as far as it helps.
void take_found(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks);
/// Effects with their errors, sizes and ties, and what of them is carried.
void judge(Diagnosis& diagnosis, const Measurement& working, const Signals& signals,
           const Blocks& blocks);
/// What the model with its effects leaves.
void look_at_the_rest(Diagnosis& diagnosis, const Signals& signals, const Blocks& blocks,
                      const Questions& questions);

}  // namespace stillhand::diagnosis
