// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace stillhand::statistics {

/// Power of the two-sided paired t-test, README Eq. ST-11, both tails counted:
///
///   power = P(|T'| > t_(1 - alpha/2, n-1)),   T' noncentral t, n - 1, noncentrality dz sqrt(n)
///
/// Source: Cohen, Statistical Power Analysis, 2nd ed., 2.2; Johnson, Kotz and Balakrishnan,
/// Continuous Univariate Distributions 2, chapter 31.  Pure.
/// @param effect_dz  [-] mean difference / standard deviation of the differences, -100 to 100
/// @param subjects   n [-], 2 to a million
/// @param alpha      [-] level of the test, between 0 and 1
/// @throws stillhand::ConfigError when an argument is outside.
double paired_t_power(double effect_dz, std::size_t subjects, double alpha = 0.05);

/// Smallest n whose power reaches the wanted one, Eq. ST-12; at least 2, at most a million.
/// @param power  [-] between 0 and 1
/// @throws stillhand::ConfigError when an argument is outside or a million are too few.
std::size_t subjects_for_power(double effect_dz, double power, double alpha = 0.05);

}  // namespace stillhand::statistics
