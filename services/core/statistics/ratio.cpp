// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/ratio.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {

std::optional<RatioInterval> ratio_interval(const std::vector<double>& x,
                                            const std::vector<double>& y, double confidence) {
  require_sample(x, 2, "ratio_interval.x");
  require_sample(y, 2, "ratio_interval.y");
  require_inside_unit_interval(confidence, "ratio_interval.confidence");
  if (x.size() != y.size()) {
    throw ConfigError("ratio_interval.y", std::to_string(y.size()) + " values",
                      std::to_string(x.size()) + ", one for each of x");
  }
  const auto n = static_cast<double>(x.size());
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  const double t = t_upper_quantile((1.0 - confidence) / 2.0, n - 1.0);
  const double factor = t * t / (n * (n - 1.0));
  const double a = mean_y * mean_y - factor * yy;
  const double b = mean_x * mean_y - factor * xy;
  const double c = mean_x * mean_x - factor * xx;
  if (!(a > 0.0)) return std::nullopt;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  return RatioInterval{mean_x / mean_y, (b - root) / a, (b + root) / a};
}

RestoredShare restored_share(const std::vector<double>& before, const std::vector<double>& after,
                             const std::vector<double>& mended) {
  std::vector<double> gained;
  std::vector<double> lost;
  for (std::size_t i = 0; i < std::min({before.size(), after.size(), mended.size()}); ++i) {
    if (!std::isfinite(before[i] + after[i] + mended[i])) continue;
    gained.push_back(after[i] - mended[i]);
    lost.push_back(after[i] - before[i]);
  }
  RestoredShare out;
  if (gained.empty()) return out;
  const double all = mean(lost);
  if (all != 0.0) out.share = mean(gained) / all;
  if (gained.size() > 1) out.interval = ratio_interval(gained, lost);
  return out;
}

}  // namespace stillhand::statistics
