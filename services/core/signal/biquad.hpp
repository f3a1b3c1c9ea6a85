// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace stillhand::signal {

/// Second-order section in transposed direct form II, Eq. SG-3:
///
///   y[n] = b0 x[n] + s1;  s1 = b1 x[n] - a1 y[n] + s2;  s2 = b2 x[n] - a2 y[n]
///
/// H(z) = (b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2).  Any unit in, the same unit out.
/// Source: Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., section 6.3.
struct Biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0;
  double s1 = 0.0, s2 = 0.0;

  double step(double x) noexcept {
    const double y = b0 * x + s1;
    s1 = b1 * x - a1 * y + s2;
    s2 = b2 * x - a2 * y;
    return y;
  }
  void reset() noexcept { s1 = s2 = 0.0; }
};

}  // namespace stillhand::signal
