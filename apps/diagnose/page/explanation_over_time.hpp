// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/diagnose/page/figures.hpp"

namespace stillhand::diagnose {

/// Effects on the input's timing: how much later the measured output is than the model's without
/// it, block by block, and what the effect says.
Explanation lag_over_time(const Evidence& evidence, const diagnosis::Effect& effect,
                          const EffectTrace& trace);

/// Effects on the gain: measured over predicted, by the channel that it hangs on or over time.
/// @param which  index in found.model.effects
Explanation local_gain(const Evidence& evidence, std::size_t which);

/// Samples that the model doesn't claim: the residual about those where it is strongest.
Explanation strongest_burst(const Evidence& evidence, const EffectTrace& trace);

}  // namespace stillhand::diagnose
