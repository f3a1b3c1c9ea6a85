// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/motion_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/motion/excitation.hpp"
#include "services/core/motion/harmonic_motion.hpp"
#include "services/core/motion/peak_limit.hpp"
#include "services/core/motion/ride.hpp"

namespace stillhand::motion {
namespace {

// Rounding of a sum that was designed to reach a bound exactly.
constexpr double kRounding = 1.0 + 1e-9;
// The corner of a ride's high-pass is found to this ratio.
constexpr double kCornerRatio = 1.001;

void check(const MotionProfile& profile) {
  validate(profile, "motion");
  if (!(profile.band_low_hz < profile.band_high_hz)) {
    throw ConfigError("motion.band_high_hz", std::to_string(profile.band_high_hz),
                      "more than band_low_hz, " + std::to_string(profile.band_low_hz));
  }
  if (profile.kind == MotionKind::kRide && profile.rms_m_s2 != 0.0) {
    throw ConfigError("motion.rms_m_s2", std::to_string(profile.rms_m_s2),
                      "0 for a ride: it is not scaled");
  }
}

struct Ramp {
  double w, w_s, w_s2;  // Eq. MO-6 and its derivatives [1/s], [1/s^2]
};

Ramp ramp_at(Tick since_start, Tick duration_ticks, Tick ramp_ticks) noexcept {
  const Tick to_end = 2 * ramp_ticks + duration_ticks - since_start;
  if (since_start >= ramp_ticks && to_end >= ramp_ticks) return {1.0, 0.0, 0.0};
  const double length = static_cast<double>(ramp_ticks);
  const bool growing = since_start < ramp_ticks;
  const double s = static_cast<double>(growing ? since_start : to_end) / length;
  const double rate_1_s = (growing ? kControlRateHz : -kControlRateHz) / length;
  return {s * s * s * (10.0 + s * (6.0 * s - 15.0)),
          30.0 * s * s * (1.0 - s) * (1.0 - s) * rate_1_s,
          60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * rate_1_s * rate_1_s};
}

// Of NaN, infinity: std::max would pass it over, and a motion that overflows would look small.
double magnitude(double value) {
  return std::isfinite(value) ? std::abs(value) : std::numeric_limits<double>::infinity();
}

}  // namespace

// Eq. MO-7.
void MotionTrajectory::fill(const MotionSpectrum& spectrum) {
  const HarmonicMotion motion(spectrum);
  const Tick total = 2 * ramp_ticks_ + duration_ticks_;
  table_.resize(static_cast<std::size_t>(total));
  report_ = {};
  double sum = 0.0;
  for (Tick i = 0; i < total; ++i) {
    const signal::MotionSample p = motion.at(i - ramp_ticks_);
    Row row{p.pos_m, p.vel_m_s, p.accel_m_s2};
    if (i >= ramp_ticks_ && i < ramp_ticks_ + duration_ticks_) {
      sum += p.accel_m_s2 * p.accel_m_s2;
      report_.peak_m_s2 = std::max(report_.peak_m_s2, magnitude(p.accel_m_s2));
    } else {
      const Ramp r = ramp_at(i, duration_ticks_, ramp_ticks_);
      row = {r.w * p.pos_m, r.w * p.vel_m_s + r.w_s * p.pos_m,
             r.w * p.accel_m_s2 + 2.0 * r.w_s * p.vel_m_s + r.w_s2 * p.pos_m};
    }
    report_.table_peak_m_s2 = std::max(report_.table_peak_m_s2, magnitude(row.acceleration_m_s2));
    report_.peak_velocity_m_s = std::max(report_.peak_velocity_m_s, magnitude(row.velocity_m_s));
    report_.peak_position_m = std::max(report_.peak_position_m, magnitude(row.position_m));
    table_[static_cast<std::size_t>(i)] = row;
  }
  report_.rms_m_s2 = std::sqrt(sum / static_cast<double>(duration_ticks_));
}

bool MotionTrajectory::within(const MotionProfile& profile,
                              const PlatformLimits& limits) const noexcept {
  return report_.peak_m_s2 <= profile.peak_m_s2 * kRounding &&
         report_.table_peak_m_s2 <= limits.max_acceleration_m_s2 &&
         report_.peak_velocity_m_s <= limits.max_velocity_m_s &&
         report_.peak_position_m <= limits.max_position_m;
}

void MotionTrajectory::refuse_unless_within(const MotionProfile& profile,
                                            const PlatformLimits& limits) const {
  if (within(profile, limits)) return;
  const auto beyond = [](const char* key, double got, double bound, const std::string& unit,
                         const char* remedy) {
    if (got <= bound) return;
    std::ostringstream value;  // short, however large
    value << got << unit;
    throw ConfigError(std::string("motion.") + key, value.str(),
                      "at most " + std::to_string(bound) + unit + remedy);
  };
  beyond("peak_m_s2", report_.peak_m_s2, profile.peak_m_s2 * kRounding, " m/s^2",
         "; lower rms_m_s2 or the amplitudes");
  beyond("band_low_hz", report_.peak_position_m, limits.max_position_m, " m",
         " of travel; raise band_low_hz or lower rms_m_s2");
  beyond("rms_m_s2", report_.peak_velocity_m_s, limits.max_velocity_m_s, " m/s",
         "; raise band_low_hz or lower rms_m_s2");
  beyond("ramp_ticks", report_.table_peak_m_s2, limits.max_acceleration_m_s2, " m/s^2",
         " in the ramps too; lengthen them or lower peak_m_s2");
}

// The lowest corner that the platform can follow, by bisection on a logarithmic scale.
void MotionTrajectory::follow_ride(const MotionProfile& profile, const PlatformLimits& limits) {
  const Ride ride(profile);
  double low_hz = profile.band_low_hz;
  double high_hz = profile.band_high_hz;
  fill(ride.above(low_hz));
  if (within(profile, limits)) {
    high_hz = low_hz;
  } else {
    const MotionSpectrum kept = ride.above(high_hz);
    fill(kept);
    refuse_unless_within(profile, limits);
  }
  while (high_hz > low_hz * kCornerRatio) {
    const double middle_hz = std::sqrt(low_hz * high_hz);
    fill(ride.above(middle_hz));
    (within(profile, limits) ? high_hz : low_hz) = middle_hz;
  }
  const MotionSpectrum kept = ride.above(high_hz);
  fill(kept);
  report_.corner_hz = high_hz;
  // Eq. MO-15.
  report_.removed_share = 1.0 - report_.rms_m_s2 * report_.rms_m_s2 / ride.variance();
  const double without_high_pass = ride.above(0.0).rms_m_s2() / kept.rms_m_s2();
  report_.removed_slow_share =
      (1.0 - report_.removed_share) * (without_high_pass * without_high_pass - 1.0);
}

MotionTrajectory::MotionTrajectory(const MotionProfile& profile, const PlatformLimits& limits)
    : duration_ticks_(profile.duration_ticks), ramp_ticks_(profile.ramp_ticks) {
  check(profile);
  validate(limits, "motion.limits");
  if (profile.kind == MotionKind::kStill) return;
  if (profile.kind == MotionKind::kRide) {
    follow_ride(profile, limits);
    return;
  }
  MotionSpectrum spectrum = profile.kind == MotionKind::kBandNoise   ? band_noise(profile)
                            : profile.kind == MotionKind::kMultisine ? multisine(profile)
                                                                     : road(profile);
  // Phases that the operator gave are kept.
  if (profile.components.empty() || profile.kind != MotionKind::kMultisine) {
    limit_peaks(spectrum,
                {std::min(profile.peak_m_s2, limits.max_acceleration_m_s2), limits.max_position_m});
  }
  fill(spectrum);
  refuse_unless_within(profile, limits);
}

}  // namespace stillhand::motion
