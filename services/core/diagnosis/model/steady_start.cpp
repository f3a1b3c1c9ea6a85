// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/steady_start.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>

#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kSettled_s = 1.0;
constexpr double kClear = 3.0;  // a mean of twice the swing counts whole

void add_levels(const std::vector<double>& levels, double sign,
                const std::vector<Stretch>& stretches, std::vector<double>& x) {
  for (std::size_t s = 0; s < stretches.size(); ++s) {
    if (levels[s] == 0.0) continue;
    for (std::size_t n = stretches[s].first; n < stretches[s].end; ++n) x[n] += sign * levels[s];
  }
}

}  // namespace

std::vector<double> start_levels(const std::vector<double>& x, const Signals& signals) {
  std::vector<double> levels;
  for (const Stretch& stretch : signals.stretches()) {
    const auto count = std::min(static_cast<std::size_t>(kSettled_s * signals.rate_hz()) + 1,
                                stretch.end - stretch.first);
    const auto first = x.begin() + static_cast<std::ptrdiff_t>(stretch.first);
    const double mean =
        Eigen::Map<const Eigen::ArrayXd>(&*first, static_cast<Eigen::Index>(count)).mean();
    const double swing =  // its square
        (Eigen::Map<const Eigen::ArrayXd>(&*first, static_cast<Eigen::Index>(count)) - mean)
            .square()
            .mean();
    const double beyond = mean * mean - swing;
    const double share = beyond > 0.0 ? std::min(beyond / (kClear * swing + 1e-300), 1.0) : 0.0;
    levels.push_back(share * mean);
  }
  return levels;
}

Settled settled(std::vector<double> x, const Signals& signals) {
  std::vector<double> before = start_levels(x, signals);
  return {std::move(x), std::move(before)};
}

Settled through_poles(const Settled& x, const std::vector<double>& denominator,
                      const std::vector<Stretch>& stretches) {
  if (denominator.size() == 1) return x;
  const double at_rest = std::accumulate(denominator.begin(), denominator.end(), 0.0);
  std::vector<double> moved = x.values;
  add_levels(x.before, -1.0, stretches, moved);
  Settled y{through_poles(moved, denominator, stretches), x.before};
  for (double& level : y.before) level /= at_rest;
  add_levels(y.before, 1.0, stretches, y.values);
  return y;
}

Settled differenced(const Settled& x, const std::vector<Stretch>& stretches) {
  Settled y{differenced(x.values, stretches), std::vector<double>(x.before.size(), 0.0)};
  for (std::size_t s = 0; s < stretches.size(); ++s) y.values[stretches[s].first] -= x.before[s];
  return y;
}

Settled late(const Settled& x, const std::vector<Stretch>& stretches) {
  Settled y = x;
  for (std::size_t s = 0; s < stretches.size(); ++s) {
    for (std::size_t n = stretches[s].end; n-- > stretches[s].first + 1;) {
      y.values[n] = y.values[n - 1];
    }
    y.values[stretches[s].first] = x.before[s];
  }
  return y;
}

void add_scaled(const Settled& x, double factor, Settled& sum) {
  for (std::size_t n = 0; n < x.values.size(); ++n) sum.values[n] += factor * x.values[n];
  for (std::size_t s = 0; s < x.before.size(); ++s) sum.before[s] += factor * x.before[s];
}

}  // namespace stillhand::diagnosis
