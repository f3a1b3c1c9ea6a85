// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// What is known of a model whose nonlinearities are held at the edges of their ranges, METHOD Eq.
/// DG-57.
enum class Stability {
  kProved,   ///< bounded, and its answers from two pasts become the same, on every input
  kTested,   ///< bounded on every input; that they become the same was tested on some
  kRefused,  ///< it swings by itself, or grows out of proportion
};

/// Pure; the surrogates' phases come from a fixed seed.
/// @param fitted  with the ranges of its effects
/// @param signals  that it was fitted to
Stability stability_of(const Model& fitted, const Signals& signals);

/// Whether the stiffness at rest falls clearly below 0 within what the model's one nonlinearity
/// reads of these signals, METHOD Eq. DG-95.
bool turns_round(const Model& fitted, const Signals& signals);

/// "proved", "tested" or "refused".
std::string name_of(Stability stability);

}  // namespace stillhand::diagnosis
