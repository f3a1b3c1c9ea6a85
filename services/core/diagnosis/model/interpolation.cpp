// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/interpolation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillhand::diagnosis {
namespace {

constexpr int kPoints = 6;
using Weights = std::array<double, kPoints>;

// Lagrange weights for a point `fraction` behind the third of six samples.
Weights lagrange(double fraction) {
  Weights weights{};
  for (int i = 0; i < kPoints; ++i) {
    double weight = 1.0;
    for (int j = 0; j < kPoints; ++j) {
      if (j != i) weight *= (fraction + 2.0 - j) / static_cast<double>(i - j);
    }
    weights[static_cast<std::size_t>(i)] = weight;
  }
  return weights;
}

// Of the samples around whole, first to last.
double weighted(std::span<const double> x, double whole, const Weights& weights) {
  const double last = static_cast<double>(x.size() - 1);
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const auto at = static_cast<std::size_t>(std::clamp(whole + i - 2.0, 0.0, last));
    sum += weights[static_cast<std::size_t>(i)] * x[at];
  }
  return sum;
}

}  // namespace

double value_at(std::span<const double> x, double place) {
  const double whole = std::floor(place);
  return weighted(x, whole, lagrange(place - whole));
}

std::vector<double> delayed(const std::vector<double>& x, const Signals& signals,
                            const std::function<double(double)>& delay_s) {
  std::vector<double> result(x.size());
  double last_fraction = -1.0;
  Weights weights{};
  for (const Stretch& stretch : signals.stretches()) {
    const auto part = std::span(x).subspan(stretch.first, stretch.end - stretch.first);
    for (std::size_t n = 0; n < part.size(); ++n) {
      const std::size_t index = stretch.first + n;
      const double position =
          static_cast<double>(n) - delay_s(signals.time_s()[index]) * signals.rate_hz();
      const double whole = std::floor(position);
      const double fraction = position - whole;
      if (fraction != last_fraction) {
        weights = lagrange(fraction);
        last_fraction = fraction;
      }
      result[index] = weighted(part, whole, weights);
    }
  }
  return result;
}

}  // namespace stillhand::diagnosis
