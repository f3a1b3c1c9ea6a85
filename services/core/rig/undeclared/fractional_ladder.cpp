// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/undeclared/fractional_ladder.hpp"

#include <cmath>
#include <numbers>

#include "services/core/contract/units.hpp"

namespace stillhand::rig {

FractionalLadder::FractionalLadder(double exponent, double period_s) {
  constexpr double kLowest_hz = 0.002;
  constexpr double kApart = 3.0;
  const double weight = std::log(kApart) * std::sin(exponent * std::numbers::pi) / std::numbers::pi;
  double rate = kTwoPi * kLowest_hz;
  for (std::size_t i = 0; i < kLags; ++i) {
    gain_[i] = weight * std::pow(rate, exponent);
    blend_[i] = 1.0 - std::exp(-period_s * rate);
    rate *= kApart;
  }
}

void FractionalLadder::step(double x) noexcept {
  for (std::size_t i = 0; i < kLags; ++i) lag_[i] += blend_[i] * (x - lag_[i]);
}

double FractionalLadder::derivative(double x) const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < kLags; ++i) sum += gain_[i] * (x - lag_[i]);
  return sum;
}

}  // namespace stillhand::rig
