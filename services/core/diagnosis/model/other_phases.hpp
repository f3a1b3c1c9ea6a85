// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/signal/random.hpp"

namespace stillhand::diagnosis {

/// A signal with the same power at every frequency and other phases, METHOD Eq. DG-57 d).  Signals
/// of one draw are turned alike, so that what they share stays shared.  Pure.
/// @param draw  the phases; taken by value
std::vector<double> other_phases(std::vector<double> x, signal::Gaussian draw);

}  // namespace stillhand::diagnosis
