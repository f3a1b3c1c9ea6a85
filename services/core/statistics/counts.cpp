// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/counts.hpp"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/binomial.hpp>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::statistics {
namespace {

void check_confidence(double confidence) {
  if (!(confidence > 0.0 && confidence < 1.0)) {
    throw ConfigError("statistics.confidence", std::to_string(confidence), "between 0 and 1");
  }
}

}  // namespace

ShareInterval share_interval(std::size_t count, std::size_t all, double confidence) {
  check_confidence(confidence);
  if (all == 0 || count > all) {
    throw ConfigError("statistics.count", std::to_string(count) + " of " + std::to_string(all),
                      "0 to all, of one or more");
  }
  const auto k = static_cast<double>(count);
  const auto n = static_cast<double>(all);
  const double tail = (1.0 - confidence) / 2.0;
  ShareInterval out{k / n, 0.0, 1.0};
  // Eq. ST-19.
  if (count > 0) out.low = quantile(boost::math::beta_distribution<>(k, n - k + 1.0), tail);
  if (count < all) {
    out.high = quantile(complement(boost::math::beta_distribution<>(k + 1.0, n - k), tail));
  }
  return out;
}

MedianInterval median_interval(std::vector<double> values, double confidence) {
  check_confidence(confidence);
  MedianInterval out;
  out.median = median(values);
  std::ranges::sort(values);
  const boost::math::binomial_distribution<> below(static_cast<double>(values.size()), 0.5);
  // Eq. ST-20: the largest k whose tail is small enough.
  std::size_t k = 0;
  while (cdf(below, static_cast<double>(k)) <= (1.0 - confidence) / 2.0) ++k;
  if (k > 0) {
    out.low = values[k - 1];
    out.high = values[values.size() - k];
  }
  return out;
}

}  // namespace stillhand::statistics
