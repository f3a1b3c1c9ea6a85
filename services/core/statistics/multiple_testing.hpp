// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stillhand::statistics {

/// p-values adjusted for being several, in the order given, at most 1: the family-wise error rate,
/// whatever the dependence, README Eq. ST-13.  No p-values give none.
/// Source: Holm, Scand. J. Stat. 6(2), 1979.  Pure.
/// @throws stillhand::ConfigError for a p-value that isn't from 0 to 1
std::vector<double> holm_adjusted(const std::vector<double>& p);

}  // namespace stillhand::statistics
