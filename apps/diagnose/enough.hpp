// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"

namespace stillhand::diagnose {

/// Fewest samples from which a verdict is made: ten for each number of the model on the folds that
/// a fit sees, and two periods of the motion: what a fold holds out, the others must have moved
/// through.  The period is Rice's, 2 pi rms(u) / rms(du/dt) of the slowest input: noise and faster
/// tones make it shorter.
std::size_t fewest_samples(const std::vector<diagnosis::Measurement>& recordings,
                           const diagnosis::DiagnoseOptions& options);

/// @throws stillhand::ConfigError that states how many would be enough
void check_enough(const std::vector<diagnosis::Measurement>& recordings,
                  const diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::diagnose
