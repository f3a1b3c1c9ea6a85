// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace stillhand::statistics {

/// Two-sided t-test of differences d_i against zero, README Eq. ST-5 and ST-6:
///
///   t = mean(d) sqrt(n) / s,   p = P(|T| >= |t|), T Student's t with n - 1 degrees of freedom
///
/// Differences carry the unit of the values.  p comes from the tail itself, so 1e-300 is as exact
/// as 0.1; below the smallest double it is 0.
struct TTest {
  std::size_t n = 0;  ///< pairs
  double mean_difference = 0.0;
  double standard_deviation = 0.0;  ///< s of the differences, with n - 1
  double t = 0.0;                   ///< [-]
  double degrees_of_freedom = 0.0;  ///< [-]
  double p = 1.0;                   ///< [-] two-sided
  double ci_low = 0.0;              ///< interval of the mean difference, Eq. ST-3
  double ci_high = 0.0;
  double confidence = 0.95;  ///< [-] of that interval
  double cohen_dz = 0.0;     ///< [-] mean difference / s
  /// [-] dz with Hedges' exact correction, Eq. ST-6; none for n = 2, where dz has no expectation
  /// that could be corrected.
  std::optional<double> hedges_gz;
};

/// Differences first[i] - second[i]: give (B, A) for the change from A to B.
///
/// Differences that agree to within the rounding of the values have no testable variance (t would
/// be the quotient of a mean and rounding noise, or 0/0) and are refused, as R's t.test does.
/// Source: Student, Biometrika 6(1), 1908; Hedges, J. Educ. Stat. 6(2), 1981.  Pure.
/// @param confidence  [-] between 0 and 1
/// @throws stillhand::ConfigError for fewer than two pairs, different lengths, a value that isn't
///         finite, differences without variance, or a confidence outside.
TTest paired_t_test(const std::vector<double>& first, const std::vector<double>& second,
                    double confidence = 0.95);

/// Test of two independent samples, README Eq. ST-18.
struct WelchTest {
  double mean_difference = 0.0;
  double t = 0.0;                   ///< [-]
  double degrees_of_freedom = 0.0;  ///< [-] by Satterthwaite, no whole number
  double p = 1.0;                   ///< [-] two-sided
  double ci_low = 0.0;              ///< interval of the mean difference
  double ci_high = 0.0;
};

/// mean(first) - mean(second) of samples whose variances may differ.
/// Source: Welch, Biometrika 34, 1947.  Pure.
/// @throws stillhand::ConfigError for a sample of fewer than two values or a value that isn't
///         finite, two samples without variance, or a confidence outside of 0 to 1
WelchTest welch_t_test(const std::vector<double>& first, const std::vector<double>& second,
                       double confidence = 0.95);

}  // namespace stillhand::statistics
