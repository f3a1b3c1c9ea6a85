// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/diagnose/page/figures.hpp"

namespace stillhand::diagnose {

/// Effects on the input's timing: the delay of the measured output behind that of the model without
/// the effect, block by block, and the effect's own delay.
Explanation lag_over_time(const Evidence& evidence, const diagnosis::Effect& effect,
                          const EffectTrace& trace);

/// Effects on the gain: measured over predicted, against the channel that it depends on or time.
/// @param which  index in found.model.effects
Explanation local_gain(const Evidence& evidence, std::size_t which);

/// Samples that the model leaves out: the residual around the strongest of them.
Explanation strongest_burst(const Evidence& evidence, const EffectTrace& trace);

}  // namespace stillhand::diagnose
