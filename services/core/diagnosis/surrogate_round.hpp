// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {

/// True when surrogates of the residual can say something about it: neither leaves its last effect
/// samples out, nor does time alone drive it, which a surrogate keeps, nor do the rows show it, Eq.
/// DG-89.
bool is_tested_by_surrogates(const Trial& trial);

/// METHOD Eq. DG-94: for each of a round the p of what it explains of the residual, linearised, by
/// chance: of each surrogate counts the largest share that any of the round explains.  0 of those
/// that are not tested.
/// @param current  the model before the round
/// @param judged  the signals by which the round was judged
std::vector<double> surrogate_p_of(const std::vector<Trial>& tried, const Model& current,
                                   const Signals& judged, const RoundSettings& settings);

}  // namespace stillhand::diagnosis
