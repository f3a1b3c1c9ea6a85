// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stillhand::statistics {

/// p-values adjusted for being several, in the order given, at most 1.  No p-values give none.
/// Pure.  Both throw stillhand::ConfigError for a p-value that isn't from 0 to 1.

/// Family-wise error rate, whatever the dependence, README Eq. ST-13.
/// Source: Holm, Scand. J. Stat. 6(2), 1979.
std::vector<double> holm_adjusted(const std::vector<double>& p);

/// False discovery rate, for independent or positively dependent tests, README Eq. ST-14.
/// Source: Benjamini and Hochberg, J. R. Stat. Soc. B 57(1), 1995.
std::vector<double> benjamini_hochberg_adjusted(const std::vector<double>& p);

}  // namespace stillhand::statistics
