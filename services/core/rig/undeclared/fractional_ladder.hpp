// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace stillhand::rig {

/// Derivative of a fractional order a between 0 and 1 by lags whose rates are a factor 3 apart from
/// 0.002 to 354 Hz, METHOD Eq. RG-35:
///
///   D^a x ~ sum g_i (x - x_i),   dx_i/dt = w_i (x - x_i),   g_i = w_i^a ln(3) sin(a pi)/pi
///
/// Pure; step() never allocates or throws.
class FractionalLadder {
 public:
  FractionalLadder(double exponent, double period_s);

  /// Advances one tick.  @param x  at the end of the tick
  void step(double x) noexcept;
  /// D^a x with the lags as they are.
  [[nodiscard]] double derivative(double x) const noexcept;

 private:
  static constexpr std::size_t kLags = 12;
  std::array<double, kLags> gain_{};
  std::array<double, kLags> blend_{};
  std::array<double, kLags> lag_{};
};

}  // namespace stillhand::rig
