// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace stillhand::signal {

/// One sinusoid of the design.
struct Component {
  std::int64_t harmonic;  ///< k [-], cycles per period, 0 < k < N/2
  double amplitude_m_s2;  ///< A [m/s^2], finite
  double phase_rad;       ///< phi [rad], finite
};

/// Acceleration with its two integrals at one instant.
struct MotionSample {
  double accel_m_s2;  ///< [m/s^2]
  double vel_m_s;     ///< [m/s]
  double pos_m;       ///< [m]
};

/// Periodic multisine acceleration with its exact integrals, Eq. SG-1:
///
///   a[n] =  sum A sin(th),  v[n] = -sum (A/w) cos(th),  x[n] = -sum (A/w^2) sin(th)
///   th = 2 pi (k n mod N)/N + phi,   w = 2 pi k rate/N
///
/// k n is reduced modulo N in integers, so samples n and n + N are bit-identical and no phase error
/// builds up.  Any unit may stand for m/s^2 when only accel_m_s2 is used.
/// Source: README Eq. SG-1; low-crest phases after Schroeder (1970), Eq. SG-2.
/// Pure: no clock, no I/O; thread-compatible; at() does not allocate.
class Multisine {
 public:
  /// Largest N: k (n mod N) then fits in 64 bits.
  static constexpr std::int64_t kMaxPeriod = std::int64_t{1} << 31;

  /// @param samples_per_period  N [-], 4 to kMaxPeriod
  /// @param rate_hz             sample rate [Hz], positive
  /// @throws stillhand::ConfigError naming the first component that breaks a bound.
  Multisine(std::int64_t samples_per_period, double rate_hz, std::vector<Component> components);

  /// Sample n, counted from the start of the run; n >= 0.
  [[nodiscard]] MotionSample at(std::int64_t n) const noexcept;

  [[nodiscard]] std::int64_t samples_per_period() const noexcept { return samples_per_period_; }
  [[nodiscard]] const std::vector<Component>& components() const noexcept { return components_; }

 private:
  std::int64_t samples_per_period_;
  double rate_hz_;
  std::vector<Component> components_;
};

/// Schroeder's low-crest phases [rad] in [0, 2 pi) for sines of the given amplitudes, in ascending
/// order of frequency, Eq. SG-2:
///
///   phi_k = -2 pi sum_{j<k} (k - j) p_j,   p_j = A_j^2 / sum A^2
///
/// Source: M. R. Schroeder, "Synthesis of low-peak-factor signals and binary sequences with low
/// autocorrelation", IEEE Trans. Inf. Theory 16(1), 1970, eq. 11.  Best for consecutive harmonics.
std::vector<double> schroeder_phases(const std::vector<double>& amplitudes);

}  // namespace stillhand::signal
