// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/core/contract/config_field.hpp"
#include "services/core/signal/multisine.hpp"

namespace stillhand::admittance {

/// Amplitude of a line over its frequency, Eq. AD-2: falls below the low corner and above the high
/// one, 1 between.
struct LineShape {
  double low_corner_hz = 0.5;
  double low_slope = 0.0;  ///< [-] power of f/f_low below the low corner
  double high_corner_hz = 20.0;
  double high_slope = 0.0;  ///< [-] power of f_high/f above the high corner

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("low_corner_hz", self.low_corner_hz, Range{0.001, 1000.0},
          "[Hz] below it amplitudes fall with the frequency");
    visit("low_slope", self.low_slope, Range{0.0, 4.0}, "[-] as this power of it");
    visit("high_corner_hz", self.high_corner_hz, Range{0.001, 1000.0},
          "[Hz] above it amplitudes fall as the frequency grows");
    visit("high_slope", self.high_slope, Range{0.0, 4.0}, "[-] as this power of it");
  }
};

/// Design of the two multisines.  The defaults are our own choice.
struct ExcitationConfig {
  double rate_hz = 1000.0;
  double period_s = 20.0;
  double lowest_hz = 0.05;
  double highest_hz = 20.0;
  std::int64_t lines = 20;              ///< of each multisine
  double peak_force_n = 8.0;            ///< [N] bound of the motor's perturbation
  double peak_acceleration_m_s2 = 2.0;  ///< [m/s^2] bound of the platform
  double peak_position_m = 0.12;        ///< [m] bound of the platform
  LineShape force{};                    ///< flat
  LineShape motion{.low_slope = 2.0};   ///< constant displacement below 0.5 Hz
  bool swapped = false;                 ///< motion takes the lines of the force, and the reverse
  bool schroeder = false;               ///< phases of Eq. SG-2; false: uniform from the seed
  std::int64_t seed = 1;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("rate_hz", self.rate_hz, Range{50.0, 10000.0}, "[Hz] samples");
    visit("period_s", self.period_s, Range{1.0, 200.0}, "[s] of both multisines");
    visit("lowest_hz", self.lowest_hz, Range{0.005, 100.0}, "[Hz] first line of the force");
    visit("highest_hz", self.highest_hz, Range{0.1, 200.0}, "[Hz] last line of the motion");
    visit("lines", self.lines, Range{2.0, 200.0}, "[-] of each multisine");
    visit("peak_force_n", self.peak_force_n, Range{0.01, 25.0}, "[N] bound of the perturbation");
    visit("peak_acceleration_m_s2", self.peak_acceleration_m_s2, Range{0.001, 10.0},
          "[m/s^2] bound of the platform's acceleration");
    visit("peak_position_m", self.peak_position_m, Range{0.001, 1.0},
          "[m] bound of the platform's position");
    visit.group("force", self.force);
    visit.group("motion", self.motion);
    visit("swapped", self.swapped, Range{0.0, 1.0},
          "[-] motion takes the lines of the force, and the force those of the motion");
    visit("schroeder", self.schroeder, Range{0.0, 1.0}, "[-] low-crest phases, or random ones");
    visit("seed", self.seed, Range{0.0, 9e15}, "[-] of the random phases");
  }
};

/// The two multisines of one period.  `force` in N (its accel_m_s2 member), `motion` in m/s^2 with
/// velocity and position.
struct Excitation {
  signal::Multisine force;
  signal::Multisine motion;
};

/// Harmonics of the period, force and motion in turn, Eq. AD-1: the largest odd number not above
/// the log-spaced frequency, and at least 2 above the one before.  Odd lines alone: what an even
/// nonlinearity adds falls between them.
/// @throws stillhand::ConfigError when the band has no room for them.
std::vector<std::int64_t> interleaved_harmonics(const ExcitationConfig& config);

/// Force of the motor + right and acceleration of the platform + right, Eqs. AD-1 to AD-3.  Their
/// peaks stay within the bounds also between the samples:
///
///   scale = min over the bounds of bound / peak of the samples * cos(pi n / N),  n the last line
///
/// Source: README.  Pure.
/// @throws stillhand::ConfigError naming the field.
Excitation design(const ExcitationConfig& config);

}  // namespace stillhand::admittance
