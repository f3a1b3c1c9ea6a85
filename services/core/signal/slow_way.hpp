// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "services/core/contract/tick.hpp"
#include "services/core/signal/smooth_step.hpp"

namespace stillhand::signal {

/// The way from where a platform stands to a command that moves, Eq. SG-21: what is added to the
/// command, which is all of the distance d at first and nothing after T, with s of SG-18:
///
///   x = d (1 - s(t/T)),   v = -d s'/T,   a = -d s''/T^2,   T = max(T_0, 15/8 |d|/V)
///
/// T_0 = 1 s, V = 0.12 m/s: at most V, 0.37 m/s^2 and 3.9 m/s^3 (d = 64 mm), our own choice.
/// Pure; never allocates or throws.
class SlowWay {
 public:
  struct Offset {
    double position_m = 0.0;
    double velocity_m_s = 0.0;
    double acceleration_m_s2 = 0.0;
  };
  static constexpr double kShortest_s = 1.0;
  static constexpr double kFastest_m_s = 0.12;

  /// @param distance_m  from the command to where the platform stands, finite
  void begin(double distance_m) noexcept {
    distance_m_ = distance_m;
    const double length_s = std::max(kShortest_s, 15.0 / 8.0 * std::abs(distance_m) / kFastest_m_s);
    length_ticks_ = std::llround(length_s * kControlRateHz);
    tick_ = 0;
  }
  /// One tick; the first is the whole distance, at rest.  Exactly zero once it is over.
  Offset step() noexcept {
    if (over()) return {};
    const double length_s = static_cast<double>(length_ticks_) * kControlPeriod_s;
    const double u = static_cast<double>(tick_++) / static_cast<double>(length_ticks_);
    return {distance_m_ * (1.0 - smooth_step(u)), -distance_m_ * smooth_step_speed(u) / length_s,
            -distance_m_ * smooth_step_bend(u) / (length_s * length_s)};
  }
  [[nodiscard]] bool over() const noexcept { return tick_ >= length_ticks_; }
  /// Of the whole way [s].
  [[nodiscard]] double length_s() const noexcept {
    return static_cast<double>(length_ticks_) * kControlPeriod_s;
  }

 private:
  double distance_m_ = 0.0;
  std::int64_t length_ticks_ = 0, tick_ = 0;
};

}  // namespace stillhand::signal
