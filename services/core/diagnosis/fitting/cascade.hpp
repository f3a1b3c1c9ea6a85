// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

/// Starts for a curve inside the body, Eq. DG-90, from a fit in which two bodies do not know each
/// other's poles.
namespace stillhand::diagnosis {

/// METHOD Eq. DG-91: the input through B_1/A_1, a curve, and B_2/A_2, as one body with the
/// poles of both.  The poles begin at those of `model`, shared out in every way that leaves the
/// slower ones on one side; the best of these fits.
/// @param model  ends with a nonlinearity inside the body, and has no other effect
/// @param drawer  draws the curve (EffectKind::drawn_after)
/// @return nullopt where no fit is finite, or the model has several inputs
std::optional<Model> cascade(const Model& model, const EffectKind& drawer, const Signals& signals);

}  // namespace stillhand::diagnosis
