// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace stillhand::device_rig {

/// Whether an accelerometer sees the platform's motion on the side to which it is commanded, METHOD
/// Eq. DR-17.  The sensor's zero and gain do not matter.  Pure; never allocates.
class SameSide {
 public:
  void reset() noexcept { *this = {}; }
  /// One call a tick while the platform follows.
  /// @param reading    of the sensor, in any unit; not finite: no call
  /// @param commanded  acceleration of the set-point [m/s^2]
  void step(double reading, double commanded) noexcept {
    if (!std::isfinite(reading) || !std::isfinite(commanded)) return;
    ++count_;
    const double n = static_cast<double>(count_);
    const double off_x = commanded - mean_x_;
    const double off_y = reading - mean_y_;
    mean_x_ += off_x / n;
    mean_y_ += off_y / n;
    s_xx_ += off_x * (commanded - mean_x_);
    s_yy_ += off_y * (reading - mean_y_);
    s_xy_ += off_x * (reading - mean_y_);
  }
  /// The correlation is below -0.3, over 3 s or more of motion with at least 0.2 m/s^2 RMS.
  [[nodiscard]] bool opposed() const noexcept {
    constexpr std::int64_t kLeast_ticks = 3000;
    constexpr double kLeast_m_s2 = 0.2;
    constexpr double kOpposed = -0.3;
    if (count_ < kLeast_ticks) return false;
    const bool moves = s_xx_ >= kLeast_m_s2 * kLeast_m_s2 * static_cast<double>(count_);
    return moves && s_yy_ > 0.0 && s_xy_ < kOpposed * std::sqrt(s_xx_ * s_yy_);
  }

 private:
  std::int64_t count_ = 0;
  double mean_x_ = 0.0, mean_y_ = 0.0;
  double s_xx_ = 0.0, s_yy_ = 0.0, s_xy_ = 0.0;
};

}  // namespace stillhand::device_rig
