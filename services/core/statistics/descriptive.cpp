// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/descriptive.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {
namespace {

std::vector<double> sorted(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

double quantile_of_sorted(const std::vector<double>& ascending, double probability) {
  const double position = static_cast<double>(ascending.size() - 1) * probability;
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, ascending.size() - 1);
  const double share = position - static_cast<double>(below);
  return ascending[below] + share * (ascending[above] - ascending[below]);
}

}  // namespace

double mean(const std::vector<double>& values) {
  require_sample(values, 1, "mean.values");
  const double n = static_cast<double>(values.size());
  double first = 0.0;
  for (const double x : values) first += x / n;
  // A second pass takes out the rounding of the first one.
  double rest = 0.0;
  for (const double x : values) rest += x - first;
  return first + rest / n;
}

double standard_deviation(const std::vector<double>& values) {
  require_sample(values, 2, "standard_deviation.values");
  const double centre = mean(values);
  double largest = 0.0;
  for (const double x : values) largest = std::max(largest, std::abs(x - centre));
  if (largest == 0.0) return 0.0;
  // Squares of very small deviations would vanish if they were not scaled.
  double sum = 0.0;
  for (const double x : values) sum += (x - centre) / largest * ((x - centre) / largest);
  return largest * std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double quantile(const std::vector<double>& values, double probability) {
  require_sample(values, 1, "quantile.values");
  if (!(probability >= 0.0 && probability <= 1.0)) {
    throw ConfigError("quantile.probability", std::to_string(probability), "a value from 0 to 1");
  }
  return quantile_of_sorted(sorted(values), probability);
}

double median(const std::vector<double>& values) { return quantile(values, 0.5); }

MeanInterval mean_interval(const std::vector<double>& values, double confidence) {
  require_sample(values, 2, "mean_interval.values");
  require_inside_unit_interval(confidence, "mean_interval.confidence");
  const double n = static_cast<double>(values.size());
  const double t = t_upper_quantile((1.0 - confidence) / 2.0, n - 1.0);
  const double half_width = t * standard_deviation(values) / std::sqrt(n);
  const double centre = mean(values);
  return {centre, centre - half_width, centre + half_width, confidence};
}

BoxPlot box_plot(const std::vector<double>& values) {
  require_sample(values, 1, "box_plot.values");
  const std::vector<double> ascending = sorted(values);
  BoxPlot out;
  out.minimum = ascending.front();
  out.maximum = ascending.back();
  out.lower_quartile = quantile_of_sorted(ascending, 0.25);
  out.median = quantile_of_sorted(ascending, 0.5);
  out.upper_quartile = quantile_of_sorted(ascending, 0.75);
  return out;
}

}  // namespace stillhand::statistics
