// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// Least squares of A(q) target = B(q) inputs + offset over the samples that count: the paper's
/// fit, where every free-run fit starts.  Output noise biases it (METHOD "Fit and
/// cross-validation"). The body's poles are bounded as METHOD Eq. DG-1 says and stable.
/// @param valid  one a sample; a row needs the sample and the one `order` samples before it
/// @throws stillhand::ConfigError for fewer than two usable samples a number.
Body equation_error_fit(const std::vector<std::vector<double>>& inputs,
                        const std::vector<double>& target, const std::vector<bool>& valid,
                        const Signals& signals, std::size_t order);

}  // namespace stillhand::diagnosis
