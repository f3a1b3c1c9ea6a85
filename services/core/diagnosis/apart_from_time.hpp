// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// [-] 0 to 1, METHOD Eq. DG-59: how surely a recording distinguishes an effect of a slow channel
/// from one of time alone.  1 for an effect of no channel, of inputs, or of channels that are not
/// slow.  Pure.
/// @param model  fitted, the effect among its effects
double apart_from_time(const Model& model, std::size_t effect, const Signals& signals,
                       const Blocks& blocks);

}  // namespace stillhand::diagnosis
