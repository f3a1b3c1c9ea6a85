// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "services/core/contract/tick.hpp"
#include "services/core/signal/multisine.hpp"

namespace stillhand::device_rig {

/// Bounds of the motion by which a platform is identified.
struct PlatformTestLimits {
  double motion_m = 0.01;  ///< largest distance from where it stands
  double max_velocity_m_s = 0.2;
  double max_acceleration_m_s2 = 2.0;
};

/// One frequency of the response.
struct PlatformLine {
  double frequency_hz;
  std::complex<double> response;  ///< state of the platform over its set-point [-]
  double error;                   ///< standard error of the response, both parts together [-]
};

/// What a platform makes of its set-point, METHOD Eq. DR-18; each with its standard error.
struct PlatformResponse {
  std::vector<PlatformLine> lines;  ///< ascending
  double gain = 0.0, gain_error = 0.0;
  double lag_s = 0.0, lag_error_s = 0.0;
  double bandwidth_hz = 0.0, bandwidth_error_hz = 0.0;
  bool bandwidth_seen = false;  ///< false: `bandwidth_hz` is the highest line, and it is beyond
  /// The accelerometer's reading over the acceleration that the platform's own state has.
  double seat_gain = 0.0, seat_gain_error = 0.0;
  bool seat_seen = false;
};

/// A multisine around the place where the platform stands, and the response to it.  It begins and
/// ends at rest: the first and the last ramp_ticks() fade it in and out.
/// Pure: no clock; at() and take() do not allocate.
class PlatformTest {
 public:
  /// @param periods  that are measured, after one in which the platform settles; 2 at least
  /// @throws ConfigError for limits that are not positive
  PlatformTest(const PlatformTestLimits& limits, std::int64_t periods);

  [[nodiscard]] Tick ticks() const noexcept;
  /// Set-point of a tick, from where the platform stood; 0 <= tick < ticks().
  [[nodiscard]] signal::MotionSample at(Tick tick) const noexcept;
  /// What was read at that tick.  A number that is not finite is a missing one.
  /// @param seat_m_s2  of the accelerometer, by its calibration; NaN: none
  void take(Tick tick, double position_m, double seat_m_s2) noexcept;
  /// @throws ConfigError if more than 1 % of the positions are missing, or nothing moved
  [[nodiscard]] PlatformResponse result() const;

 private:
  using Complex = std::complex<double>;
  /// Fourier sums of one period, one for each line.
  struct Period {
    std::vector<Complex> set_point, position, seat;
  };

  signal::Multisine motion_;
  std::int64_t periods_;
  std::vector<Period> sums_;
  std::int64_t missing_ = 0, seats_ = 0;
  double held_m_ = 0.0, held_m_s2_ = 0.0;
};

}  // namespace stillhand::device_rig
