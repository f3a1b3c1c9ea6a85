// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/jackknife.hpp"

#include <cmath>
#include <vector>

#include "services/core/statistics/distributions.hpp"

namespace stillhand::session {

double jackknife_variance(const std::function<double(std::size_t)>& without) {
  constexpr auto kCount = static_cast<double>(kJackknifeBlocks);
  std::vector<double> values;
  double mean = 0.0;
  for (std::size_t b = 0; b < kJackknifeBlocks; ++b) {
    values.push_back(without(b));
    mean += values.back() / kCount;
  }
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return squares * (kCount - 1.0) / kCount;
}

double jackknife_reach(double variance) {
  return statistics::t_upper_quantile(0.025, kJackknifeBlocks - 1) * std::sqrt(variance);
}

}  // namespace stillhand::session
