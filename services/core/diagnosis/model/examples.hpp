// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/signals.hpp"

namespace stillhand::diagnosis {

/// Each kind (effects/examples.cpp) as this recording could have it, next to a model: one of every
/// channel that it may read, with middling numbers (thresholds of about a standard deviation).  Its
/// size is not meant: Eq. DG-62 takes what it adds to the prediction times a factor.  A kind that
/// the channels do not allow is not among them.
std::vector<Effect> examples(const Model& model, const Signals& signals);

}  // namespace stillhand::diagnosis
