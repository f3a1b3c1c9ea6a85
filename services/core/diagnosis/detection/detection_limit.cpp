// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection_limit.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace stillhand::diagnosis {
namespace {

constexpr double kLongestCorrelation_s = 10.0;
constexpr double kUncorrelated = 0.05;  // a correlation below it ends the sum
constexpr double kLargestShift = 8.0;

// Mean over deviation of normal differences at which the signed-rank test of `blocks` of them
// reaches this p as often as not.  Mean of the statistic: Lehmann, Nonparametrics, 1975, eq. 4.23.
double shift_for(double p, double blocks) {
  const boost::math::normal normal;
  const double pairs = 0.5 * blocks * (blocks - 1.0);
  const double z = boost::math::quantile(boost::math::complement(normal, p));
  const double wanted = 0.25 * blocks * (blocks + 1.0) +
                        z * std::sqrt(blocks * (blocks + 1.0) * (2.0 * blocks + 1.0) / 24.0);
  const double most = 0.5 * blocks * (blocks + 1.0);  // every difference is positive
  if (wanted >= most) return std::numeric_limits<double>::infinity();
  double low = 0.0;
  double high = kLargestShift;
  while (high - low > 1e-6) {
    const double shift = 0.5 * (low + high);
    const double mean = blocks * boost::math::cdf(normal, shift) +
                        pairs * boost::math::cdf(normal, std::numbers::sqrt2 * shift);
    (mean < wanted ? low : high) = shift;
  }
  return high;
}

// [-] of the residual's RMS, for a p and a fall that the rule asks for.
double limit_for(double p, double fall, const RoundEvidence& round) {
  const auto blocks = static_cast<double>(std::max<std::size_t>(round.blocks, 1));
  const double shift = shift_for(p, blocks);
  const double by_chance = 2.0 * shift / std::sqrt(std::max(round.independent / blocks, 1.0));
  return std::max(by_chance, std::sqrt(1.0 / std::pow(1.0 - fall, 2) - 1.0));
}

}  // namespace

double correlation_samples(const Eigen::VectorXd& residual, double rate_hz) {
  const double power = std::max(residual.squaredNorm(), 1e-300);
  const Eigen::Index count = residual.size();
  const auto longest =
      std::min(count / 4, static_cast<Eigen::Index>(kLongestCorrelation_s * rate_hz));
  double sum = 1.0;
  for (Eigen::Index lag = 1; lag <= longest; ++lag) {
    const double rho = residual.head(count - lag).dot(residual.tail(count - lag)) / power;
    if (rho < kUncorrelated) break;
    sum += 2.0 * rho;
  }
  return sum;
}

double detection_limit(const RoundEvidence& round, const SearchOptions& options) {
  const auto candidates = static_cast<double>(std::max<std::size_t>(round.candidates, 1));
  return round.rmse *
         std::min(limit_for(options.significance / candidates, options.first_least_fall, round),
                  limit_for(options.large_significance, options.large_fall, round));
}

}  // namespace stillhand::diagnosis
