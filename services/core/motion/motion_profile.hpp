// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/multisine.hpp"

namespace stillhand::motion {

/// Kind of platform motion; the values are those of stillhand_msgs::MotionKind.
enum class MotionKind : std::uint8_t {
  kStill = 0,      ///< no motion (condition A)
  kBandNoise = 1,  ///< random-phase noise, flat in its band (paper III-A, III-C)
  kMultisine = 2,  ///< a few sinusoids, whole cycles in the trial
  kRoad = 3,       ///< ISO 8608 road profile
  kRide = 4,       ///< a recorded ride
};

/// "still", "band_noise", "multisine", "road" or "ride".
std::string_view to_string(MotionKind kind) noexcept;

/// What a band may hold, skirts included [Hz].
inline constexpr double kLowestBand_hz = 0.02;
inline constexpr double kHighestBand_hz = 40.0;

/// What a trial asks of the platform.  Settings that a kind does not use are named so below.
struct MotionProfile {
  MotionKind kind = MotionKind::kStill;
  std::uint64_t seed = 1;  ///< [-] phases of band noise, multisine without components, and road
  double band_low_hz = 0.7;
  double band_high_hz = 2.0;
  std::int64_t band_order = 0;  ///< roll-off of band noise at each edge; 0: none outside the band
  double rms_m_s2 = 1.6;  ///< noise: exact; multisine, road: 0 keeps their own; ride: must be 0
  double peak_m_s2 = 7.5;
  Tick duration_ticks = 180'000;
  Tick ramp_ticks = 2'000;
  double road_speed_m_s = 20.0;
  std::string road_class = "B";
  double ride_rate_hz = 0.0;                  ///< [Hz] rate of ride_accel_m_s2; ride only
  std::vector<double> ride_accel_m_s2;        ///< [m/s^2] uniform, from the first measured tick
  std::vector<signal::Component> components;  ///< multisine; harmonics of the measured duration

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("band_low_hz", self.band_low_hz, Range{kLowestBand_hz, kHighestBand_hz},
          "[Hz] lower edge; ride: lowest corner tried; paper III-A, 0.7 Hz");
    visit("band_high_hz", self.band_high_hz, Range{kLowestBand_hz, kHighestBand_hz},
          "[Hz] upper edge; paper III-A 4 Hz, III-C 2 Hz");
    visit("band_order", self.band_order, Range{0.0, 8.0},
          "[-] Butterworth order of each edge of band noise, down to -40 dB; 0: an abrupt end");
    visit("rms_m_s2", self.rms_m_s2, Range{0.0, 10.0},
          "[m/s^2] acceleration, RMS of the measured part; paper III-C, 1.6 m/s^2; 0: multisine, "
          "road and ride keep their own");
    visit("peak_m_s2", self.peak_m_s2, Range{0.01, 15.0},
          "[m/s^2] largest acceleration in the measured part; paper III-C 7.5, III-A 0.75 g");
    visit("duration_ticks", self.duration_ticks, Range{100.0, 3.6e6},
          "[ticks] measured length; paper: 120 s (III-A), 180 s (III-C)");
    visit("ramp_ticks", self.ramp_ticks, Range{100.0, 60000.0},
          "[ticks] length of each ramp, before and after the measured part");
    visit("road_speed_m_s", self.road_speed_m_s, Range{0.5, 70.0},
          "[m/s] vehicle speed; road only");
    visit("road_class", self.road_class, Range{1.0, 1.0},
          "road class A (very good) to H; ISO 8608:2016; road only");
  }
};

}  // namespace stillhand::motion
