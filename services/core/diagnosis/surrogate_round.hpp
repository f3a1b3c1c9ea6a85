// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {

/// True when surrogates of the residual say something about it: its last effect depends on an
/// input, a channel or a state, and the rows alone do not show it (Eq. DG-89).  A surrogate keeps
/// what time alone explains.
bool is_tested_by_surrogates(const Trial& trial);

/// METHOD Eq. DG-94: p of what the chosen one explains of the residual, linearised, by chance: of
/// each surrogate counts the largest share that any of the round explains.
/// @param current  the model before the round
/// @param judged  the signals by which the round was judged
double surrogate_p_of(const std::vector<Trial>& tried, std::size_t chosen, const Model& current,
                      const Signals& judged, const RoundSettings& settings);

}  // namespace stillhand::diagnosis
