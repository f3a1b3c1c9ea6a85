// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "services/core/contract/tick.hpp"
#include "services/core/signal/multisine.hpp"

namespace stillhand::motion {

/// A periodic acceleration by its harmonics, Eq. MO-8:
///
///   a(t) = Re sum_k C_k exp(j w_k t),   w_k = 2 pi k / T,   k = first .. first + size - 1
///
/// with the integrals v: C_k / (j w_k) and x: -C_k / w_k^2.  No constant term: first >= 1.
struct MotionSpectrum {
  double period_s = 0.0;                         ///< T [s]
  std::int64_t first = 1;                        ///< [-] harmonic of the first line
  std::vector<std::complex<double>> accel_m_s2;  ///< C_k [m/s^2], peak amplitudes

  [[nodiscard]] double rad_s(std::size_t line) const noexcept {
    return 2.0 * std::numbers::pi * static_cast<double>(first + static_cast<std::int64_t>(line)) /
           period_s;
  }
  /// Root of the mean square over a whole period [m/s^2] (Parseval).
  [[nodiscard]] double rms_m_s2() const noexcept;
  void scale(double factor) noexcept;
};

/// Points of the synthesis grid for a spectrum: 2, 3 and 5 its only factors, at least 25 a cycle of
/// the highest harmonic, so that w h <= 2 pi / 25.
std::size_t grid_size(const MotionSpectrum& spectrum);

/// Acceleration and position on the grid, by inverse FFT; sizes grid_size().
struct MotionGrid {
  std::vector<double> accel_m_s2;
  std::vector<double> position_m;
};
MotionGrid on_grid(const MotionSpectrum& spectrum);

/// The motion of a spectrum at any time, Eq. MO-9: x, v, a and jerk on the grid by inverse FFT, and
/// between two points the polynomial of degree 7 that meets all eight values.  x, v and a are exact
/// derivatives of each other, with three continuous derivatives; against MO-8 the relative error is
/// below (w h)^8 / 1.0e7 in x and (w h)^6 / 3e5 in a, 2e-12 and 1e-9 at the band's upper edge.
/// Works for every period, also one of a prime number of ticks.  Pure once built; at() allocates
/// nothing.
class HarmonicMotion {
 public:
  explicit HarmonicMotion(const MotionSpectrum& spectrum);

  /// @param n  [ticks] from t = 0; any sign
  [[nodiscard]] signal::MotionSample at(Tick n) const noexcept;

 private:
  std::vector<std::array<double, 8>> cells_;  // polynomial in the cell's own 0..1, [m]
  double cells_per_tick_;
  double cells_per_s_;
};

}  // namespace stillhand::motion
