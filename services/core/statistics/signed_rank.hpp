// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stillhand::statistics {

/// Wilcoxon's signed-rank test of paired differences, one-sided: p of a rank sum of the positive
/// ones as large as this when every sign is a coin toss, README Eq. ST-15.  Zeros are left out,
/// ties share their mean rank.  Exact up to 25 differences without ties, else the normal
/// approximation with correction for continuity and ties (R's wilcox.test() is exact up to 49). No
/// difference that isn't zero: p = 1. Source: Wilcoxon, Biometrics Bull. 1(6), 1945; Hollander,
/// Wolfe and Chicken, Nonparametric Statistical Methods, 3rd ed., 3.1.  Pure.
/// @throws stillhand::ConfigError for no difference or one that isn't finite.
double signed_rank_p(const std::vector<double>& differences);

/// The same, two-sided: twice the smaller of both one-sided p, at most 1, README Eq. ST-17.
/// @throws as signed_rank_p()
double signed_rank_two_sided_p(const std::vector<double>& differences);

}  // namespace stillhand::statistics
