// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/t_test.hpp"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {
namespace {

double largest_magnitude(const std::vector<double>& values) {
  double out = 0.0;
  for (const double x : values) out = std::max(out, std::abs(x));
  return out;
}

// Two numbers of magnitude m that are rounded to double and subtracted leave an error of up to
// 4 u m, u half an epsilon: equal differences may look 4 epsilon m apart.
bool constant_within_rounding(const std::vector<double>& differences, double magnitude) {
  const auto [low, high] = std::minmax_element(differences.begin(), differences.end());
  return *high - *low <= 4.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

// Gamma(v/2) / (sqrt(v/2) Gamma((v-1)/2)), Eq. ST-6; by the quotient, since either factor
// overflows from v = 342.
double hedges_correction(double degrees_of_freedom) {
  const double half = degrees_of_freedom / 2.0;
  return 1.0 / (std::sqrt(half) * boost::math::tgamma_delta_ratio(half - 0.5, 0.5));
}

TTest test_of(const std::vector<double>& differences, double magnitude, double confidence) {
  if (constant_within_rounding(differences, magnitude)) {
    throw ConfigError("t_test.differences", "no variance (all are the same within rounding)",
                      "differences that vary");
  }
  TTest out;
  out.n = differences.size();
  const double n = static_cast<double>(out.n);
  const MeanInterval interval = mean_interval(differences, confidence);
  out.mean_difference = interval.mean;
  out.ci_low = interval.low;
  out.ci_high = interval.high;
  out.confidence = confidence;
  out.standard_deviation = standard_deviation(differences);
  out.degrees_of_freedom = n - 1.0;
  out.cohen_dz = out.mean_difference / out.standard_deviation;
  out.t = out.cohen_dz * std::sqrt(n);
  out.p = 2.0 * t_above(std::abs(out.t), out.degrees_of_freedom);
  if (out.n > 2) out.hedges_gz = hedges_correction(out.degrees_of_freedom) * out.cohen_dz;
  return out;
}

}  // namespace

TTest paired_t_test(const std::vector<double>& first, const std::vector<double>& second,
                    double confidence) {
  require_sample(first, 2, "t_test.first");
  require_sample(second, 2, "t_test.second");
  require_inside_unit_interval(confidence, "t_test.confidence");
  if (first.size() != second.size()) {
    throw ConfigError("t_test.second", std::to_string(second.size()) + " values",
                      std::to_string(first.size()) + ", as many as in the first sample");
  }
  std::vector<double> differences(first.size());
  std::transform(first.begin(), first.end(), second.begin(), differences.begin(),
                 [](double a, double b) { return a - b; });
  return test_of(differences, std::max(largest_magnitude(first), largest_magnitude(second)),
                 confidence);
}

WelchTest welch_t_test(const std::vector<double>& first, const std::vector<double>& second,
                       double confidence) {
  require_sample(first, 2, "t_test.first");
  require_sample(second, 2, "t_test.second");
  require_inside_unit_interval(confidence, "t_test.confidence");
  // Variances of the two means.
  const auto of_mean = [](const std::vector<double>& values) {
    const double s = standard_deviation(values);
    return s * s / static_cast<double>(values.size());
  };
  const double a = of_mean(first);
  const double b = of_mean(second);
  if (!(a + b > 0.0)) {
    throw ConfigError("t_test.first", "no variance in either sample", "values that vary");
  }
  WelchTest out;
  out.mean_difference = mean(first) - mean(second);
  out.t = out.mean_difference / std::sqrt(a + b);
  out.degrees_of_freedom = (a + b) * (a + b) /
                           (a * a / (static_cast<double>(first.size()) - 1.0) +
                            b * b / (static_cast<double>(second.size()) - 1.0));
  out.p = 2.0 * t_above(std::abs(out.t), out.degrees_of_freedom);
  const double reach =
      t_upper_quantile((1.0 - confidence) / 2.0, out.degrees_of_freedom) * std::sqrt(a + b);
  out.ci_low = out.mean_difference - reach;
  out.ci_high = out.mean_difference + reach;
  return out;
}

}  // namespace stillhand::statistics
