// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/power.hpp"

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {
namespace {

constexpr std::size_t kMostSubjects = 1'000'000;
// Beyond it the series of the noncentral t may take more terms than Boost counts.
constexpr double kLargestEffect = 100.0;

// True when the power differs from 1 by less than half an epsilon.  T' = (Z + delta) / sqrt(V / v)
// stays below the critical value only if Z < -delta / 2 or V > v (delta / (2 critical))^2.  Boost's
// series is slow there.
bool certain(double noncentrality, double critical, double degrees_of_freedom) {
  const double quotient = noncentrality / (2.0 * critical);
  if (quotient <= 1.0) return false;
  return normal_below(-noncentrality / 2.0) +
             chi_squared_above(degrees_of_freedom * quotient * quotient, degrees_of_freedom) <
         std::numeric_limits<double>::epsilon() / 2.0;
}

}  // namespace

double paired_t_power(double effect_dz, std::size_t subjects, double alpha) {
  if (!(std::abs(effect_dz) <= kLargestEffect)) {
    throw ConfigError("power.effect_dz", std::to_string(effect_dz), "a value from -100 to 100");
  }
  require_inside_unit_interval(alpha, "power.alpha");
  if (subjects < 2 || subjects > kMostSubjects) {
    throw ConfigError("power.subjects", std::to_string(subjects), "2 to a million");
  }
  const double n = static_cast<double>(subjects);
  const double critical = t_upper_quantile(alpha / 2.0, n - 1.0);
  const double noncentrality = std::abs(effect_dz) * std::sqrt(n);
  if (noncentrality == 0.0) return alpha;
  if (certain(noncentrality, critical, n - 1.0)) return 1.0;
  const boost::math::non_central_t distribution(n - 1.0, noncentrality);
  // Boost's far tails may be off by an epsilon to either side.
  return std::clamp(cdf(complement(distribution, critical)) + cdf(distribution, -critical), 0.0,
                    1.0);
}

std::size_t subjects_for_power(double effect_dz, double power, double alpha) {
  require_inside_unit_interval(power, "power.power");
  std::size_t enough = 2;
  while (paired_t_power(effect_dz, enough, alpha) < power) {
    if (enough == kMostSubjects) {
      throw ConfigError("power.effect_dz", std::to_string(effect_dz),
                        "an effect that a million subjects show with this power");
    }
    enough = std::min(2 * enough, kMostSubjects);
  }
  // Power grows with n, so the smallest one lies above half of the first power of two that will do.
  std::size_t too_few = enough == 2 ? 1 : enough / 2;
  while (enough - too_few > 1) {
    const std::size_t middle = too_few + (enough - too_few) / 2;
    (paired_t_power(effect_dz, middle, alpha) < power ? too_few : enough) = middle;
  }
  return enough;
}

}  // namespace stillhand::statistics
