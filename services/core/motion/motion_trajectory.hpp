// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/motion/harmonic_motion.hpp"
#include "services/core/motion/motion_profile.hpp"
#include "services/core/motion/platform_command.hpp"
#include "services/core/motion/platform_guard.hpp"

namespace stillhand::motion {

/// What a trajectory came out as; recorded with the trial.
struct MotionReport {
  double rms_m_s2 = 0.0;            ///< [m/s^2] acceleration, measured part
  double peak_m_s2 = 0.0;           ///< [m/s^2] largest |a|, measured part
  double table_peak_m_s2 = 0.0;     ///< [m/s^2] largest |a|, ramps included
  double peak_velocity_m_s = 0.0;   ///< [m/s] largest |v|, ramps included
  double peak_position_m = 0.0;     ///< [m] largest |x|, ramps included
  double corner_hz = 0.0;           ///< [Hz] ride: high-pass corner found; otherwise 0
  double removed_share = 0.0;       ///< [-] ride: 1 - var(a) / var(recorded a), measured part
  double removed_slow_share = 0.0;  ///< [-] the part of it that the high-pass took
};

/// The motion of one trial, synthesised whole when the trial is armed: position, velocity and
/// acceleration at 1 kHz, exact derivatives of each other, ramps included.  A quintic ramp w
/// multiplies the position, README Eq. MO-6, and the other two follow as exact products, Eq. MO-7:
///
///   w(s) = 10 s^3 - 15 s^4 + 6 s^5
///   x = w p,   v = w p' + w' p,   a = w p'' + 2 w' p' + w'' p
///
/// It starts and ends at x = v = a = 0, and every sample is within the limits given, so that
/// PlatformGuard passes it unchanged.  Construction allocates and takes milliseconds: keep it out
/// of the control path.  at() is pure, allocates nothing, and may be called from any thread.
class MotionTrajectory {
 public:
  /// No motion, no length.
  MotionTrajectory() = default;

  /// @throws stillhand::ConfigError when the profile is out of range, contradicts itself, or asks
  ///         for what the limits do not allow.
  MotionTrajectory(const MotionProfile& profile, const PlatformLimits& limits);

  /// @param since_ramp_start  [ticks] since the first tick of the first ramp; zero motion outside.
  [[nodiscard]] PlatformCommand at(Tick since_ramp_start) const noexcept {
    if (since_ramp_start < 0 || static_cast<std::size_t>(since_ramp_start) >= table_.size())
      return {};
    return table_[static_cast<std::size_t>(since_ramp_start)].command();
  }

  [[nodiscard]] Tick duration_ticks() const noexcept { return duration_ticks_; }
  [[nodiscard]] Tick ramp_ticks() const noexcept { return ramp_ticks_; }
  [[nodiscard]] const MotionReport& report() const noexcept { return report_; }

 private:
  // A command without flags: a quarter less memory.
  struct Row {
    double position_m, velocity_m_s, acceleration_m_s2;
    [[nodiscard]] PlatformCommand command() const noexcept {
      return {position_m, velocity_m_s, acceleration_m_s2, kGood};
    }
  };

  void fill(const MotionSpectrum& spectrum);
  void follow_ride(const MotionProfile& profile, const PlatformLimits& limits);
  [[nodiscard]] bool within(const MotionProfile& profile,
                            const PlatformLimits& limits) const noexcept;
  void refuse_unless_within(const MotionProfile& profile, const PlatformLimits& limits) const;

  std::vector<Row> table_;
  Tick duration_ticks_ = 0;
  Tick ramp_ticks_ = 0;
  MotionReport report_;
};

}  // namespace stillhand::motion
