// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "services/core/vehicle/vehicle_config.hpp"

namespace stillhand::vehicle {

/// A frequency response that was identified, with its uncertainty; frequencies rise.
struct IdentifiedResponse {
  std::vector<double> frequency_hz;
  std::vector<std::complex<double>> response;
  std::vector<double> variance;  ///< E|R - truth|^2 of each; empty: not known

  /// Straight lines between the points, in real and imaginary part over the logarithm of the
  /// frequency; the end's value outside.
  [[nodiscard]] std::complex<double> at(double frequency_hz) const noexcept;
};

/// How near a loop is to its limit.
struct Margin {
  double critical_gain_m_s2_rad = 0.0;  ///< smallest gain at which the loop is not stable
  double frequency_hz = 0.0;            ///< of the oscillation at that gain
  bool stable = false;                  ///< gain below critical gain
};

/// Margin of the loop through vehicle and hand, METHOD Eq. VH-9:
///
///   L(jw) = V(jw) Theta(jw),   1 - L = 0 on the limit
///   G_critical = G / max { Re L(jw): Im L(jw) = 0, Re L(jw) > 0 }
///
/// V is vehicle_response(), Theta [rad per m/s^2] the stick's answer to commanded acceleration, of
/// a hand alone or with cancellation: stable in itself, which a stick at rest in a moving vehicle
/// shows.  Then L starts inside 1 for a small gain, and the first crossing of 1 as the gain grows
/// is the limit (Nyquist).  Searched on `steps` frequencies, log-spaced over those of Theta, with a
/// straight line between two; infinite gain where L never crosses.
/// Pure.  @throws stillhand::ConfigError when Theta has no two frequencies, which rise.
Margin margin(const VehicleConfig& config, const IdentifiedResponse& theta, int steps = 600);

/// Critical gain with the uncertainty of its response: quantiles of `draws` responses, each point
/// moved by a circular normal deviate of its variance, independently.
struct GainInterval {
  double gain_m_s2_rad;                ///< of the response itself
  double low_m_s2_rad, high_m_s2_rad;  ///< 2.5 and 97.5 % of the draws
};
/// Source: METHOD Eq. VH-11.  Pure: the same seed gives the same draws.
/// @throws as margin()
GainInterval critical_gain(const VehicleConfig& config, const IdentifiedResponse& theta,
                           int draws = 200, std::uint64_t seed = 1);

}  // namespace stillhand::vehicle
