// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Distributions of Boost.Math behind plain functions.  Each is instantiated once: a file that
/// names one of Boost's takes 2 to 4 s more to compile.  An upper tail is computed as such, so that
/// a small one keeps its digits.  Pure. Degrees of freedom are above 0, probabilities between 0 and
/// 1, values of chi-squared and F at least 0; otherwise they throw std::domain_error.
namespace stillhand::statistics {

/// P(Z <= z) and P(Z > z) of the standard normal distribution.
double normal_below(double z);
double normal_above(double z);

/// P(T > t) of Student's t.
double t_above(double t, double degrees_of_freedom);
/// The t with P(T <= t) = p.
double t_quantile(double p, double degrees_of_freedom);
/// The t with P(T > t) = p.
double t_upper_quantile(double p, double degrees_of_freedom);

/// P(X > x) of chi-squared.
double chi_squared_above(double x, double degrees_of_freedom);
/// The x with P(X <= x) = p.
double chi_squared_quantile(double p, double degrees_of_freedom);

/// P(F > f) of Fisher's F.
double f_above(double f, double numerator_df, double denominator_df);
/// The f with P(F <= f) = p.
double f_quantile(double p, double numerator_df, double denominator_df);

}  // namespace stillhand::statistics
