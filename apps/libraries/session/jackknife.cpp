// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/jackknife.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>

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
  const boost::math::students_t spread(static_cast<double>(kJackknifeBlocks - 1));
  return quantile(complement(spread, 0.025)) * std::sqrt(variance);
}

}  // namespace stillhand::session
