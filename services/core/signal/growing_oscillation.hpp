// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::signal {

/// When an oscillation of the stick ends what drives it: a vehicle, or a part of the motor.
struct OscillationLimits {
  double low_hz = 0.7;
  double high_hz = 10.0;
  double floor_rad = 0.04;
  double ceiling_rad = 0.08;
  double growth = 1.05;
  double regularity = 1.6;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("low_hz", self.low_hz, Range{0.3, 5.0},
          "[Hz] slowest oscillation that is looked for; own choice, above a person's steering");
    visit("high_hz", self.high_hz, Range{2.0, 40.0},
          "[Hz] fastest; own choice, above the resonances of arm and stick");
    visit("floor_rad", self.floor_rad, Range{0.005, 0.3},
          "[rad] smallest amplitude that counts as growing; own choice, 4 mm at the hand");
    visit("ceiling_rad", self.ceiling_rad, Range{0.01, 0.5},
          "[rad] amplitude that no oscillation may hold, growing or not; own choice, twice the "
          "floor");
    visit("growth", self.growth, Range{1.0, 2.0},
          "[-] from each half wave to the next, three times in a row");
    visit("regularity", self.regularity, Range{1.05, 4.0},
          "[-] longest half wave over shortest of the last three");
  }
};

/// Detects a growing oscillation of the stick, Eq. VH-6 to VH-8 (processes/vehicle), and stays with
/// its finding until reset().  y is the stick behind a band-pass; a half wave lasts from one change
/// of sign to the next, and p_k is its largest |y|, p_0 that of the one that goes on:
///
///   regular:   longest / shortest of the last three half waves <= regularity, each in the band
///   growing:   regular, p_0 >= floor,  p_k >= growth p_(k+1) for k = 0, 1, 2        (VH-7)
///   too large: the last three half waves in the band, p_0, p_1, p_2 >= ceiling       (VH-8)
///
/// Four half waves are two periods, and three of them one and a half, which leaves room for the
/// band-pass: either finding comes at most two periods after the amplitude passed its bound.  A
/// stick that is not finite counts as one at its last place. Pure; bounded work a tick, no
/// allocation after construction; one thread.
class GrowingOscillation {
 public:
  /// @throws stillhand::ConfigError when floor or low_hz is not below ceiling or high_hz.
  explicit GrowingOscillation(const OscillationLimits& limits);

  /// One tick.  @return true from the tick of the finding on
  bool step(double theta_rad) noexcept;
  /// Forgets the finding and all motion; the next sample is taken as the stick's rest.
  void reset() noexcept;

  [[nodiscard]] bool found() const noexcept { return found_; }
  /// [Hz] of the oscillation found, from its last two half waves; 0 before.
  [[nodiscard]] double frequency_hz() const noexcept { return frequency_hz_; }
  /// [rad] largest |y| of the half wave that goes on.
  [[nodiscard]] double amplitude_rad() const noexcept { return now_.peak_rad; }
  /// [rad] the same of the half wave before it.
  [[nodiscard]] double last_amplitude_rad() const noexcept { return past_[0].peak_rad; }

 private:
  struct HalfWave {
    double peak_rad = 0.0;
    Tick ticks = 0;
  };
  [[nodiscard]] bool in_band() const noexcept;
  [[nodiscard]] bool regular() const noexcept;
  [[nodiscard]] bool grows() const noexcept;
  [[nodiscard]] bool too_large() const noexcept;
  void next_half_wave() noexcept;

  OscillationLimits limits_;
  Butterworth high_pass_;
  Butterworth low_pass_;
  std::array<HalfWave, 3> past_{};  ///< newest first
  HalfWave now_;
  Tick longest_;
  Tick shortest_;
  double sign_ = 0.0;
  double rest_rad_ = 0.0;
  double last_rad_ = 0.0;
  bool started_ = false;
  bool found_ = false;
  double frequency_hz_ = 0.0;
};

}  // namespace stillhand::signal
