// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/platform_response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/smooth_step.hpp"

namespace stillhand::device_rig {
namespace {

constexpr Tick kPeriod_ticks = 2000;
constexpr Tick kRamp_ticks = 2000;
// 0.5 to 20 Hz, spread over the octaves: the motion of a trial has 0.7 to 4 Hz, and the paper asks
// for a bandwidth beyond 6 Hz.
constexpr std::array<std::int64_t, 12> kHarmonics{1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 34, 40};
constexpr double kCorner_hz = 2.0;  // below it all amplitudes are alike, beyond all accelerations
constexpr double kLowest_lag_hz = 0.5, kHighest_lag_hz = 4.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

double frequency_hz(std::int64_t harmonic) {
  return kControlRateHz * static_cast<double>(harmonic) / static_cast<double>(kPeriod_ticks);
}

/// Amplitudes in the shape that is wanted, scaled to the tightest of the limits.
signal::Multisine multisine(const PlatformTestLimits& limits) {
  const auto make = [](double scale) {
    std::vector<double> amplitudes_m_s2;
    for (const std::int64_t harmonic : kHarmonics) {
      const double f_hz = frequency_hz(harmonic);
      const double amplitude_m = scale / (1.0 + f_hz * f_hz / (kCorner_hz * kCorner_hz));
      amplitudes_m_s2.push_back(amplitude_m * kTurn * f_hz * kTurn * f_hz);
    }
    const std::vector<double> phases = signal::schroeder_phases(amplitudes_m_s2);
    std::vector<signal::Component> components;
    for (std::size_t i = 0; i < kHarmonics.size(); ++i) {
      components.push_back({kHarmonics[i], amplitudes_m_s2[i], phases[i]});
    }
    return signal::Multisine(kPeriod_ticks, kControlRateHz, components);
  };
  const signal::Multisine unit = make(1.0);
  signal::MotionSample most{0.0, 0.0, 0.0};
  for (Tick tick = 0; tick < kPeriod_ticks; ++tick) {
    const auto each = unit.at(tick);
    most.pos_m = std::max(most.pos_m, std::abs(each.pos_m));
    most.vel_m_s = std::max(most.vel_m_s, std::abs(each.vel_m_s));
    most.accel_m_s2 = std::max(most.accel_m_s2, std::abs(each.accel_m_s2));
  }
  return make(std::min({limits.motion_m / most.pos_m, limits.max_velocity_m_s / most.vel_m_s,
                        limits.max_acceleration_m_s2 / most.accel_m_s2}));
}

/// Eq. SG-18 with its derivatives by time: velocity and acceleration stay continuous.
struct Fade {
  double value, rate_s, bend_s2;
};
Fade fade(double u, double length_s) {
  u = std::clamp(u, 0.0, 1.0);
  return {signal::smooth_step(u), signal::smooth_step_speed(u) / length_s,
          signal::smooth_step_bend(u) / (length_s * length_s)};
}

/// Mean of complex numbers, and its standard error.
struct Mean {
  std::complex<double> value;
  double error;
};
Mean mean_of(const std::vector<std::complex<double>>& all) {
  const auto n = static_cast<double>(all.size());
  std::complex<double> sum = 0.0;
  for (const auto& each : all) sum += each;
  const std::complex<double> mean = sum / n;
  double squares = 0.0;
  for (const auto& each : all) squares += std::norm(each - mean);
  return {mean, std::sqrt(squares / (n * (n - 1.0)))};
}

double radians_apart(double from, double to) { return std::remainder(to - from, kTurn); }

void fit_lag(PlatformResponse& out) {
  double phase = 0.0;
  double s_ww = 0.0, s_wp = 0.0, noise = 0.0;
  std::vector<std::array<double, 2>> points;
  for (const PlatformLine& line : out.lines) {
    phase += radians_apart(phase, -std::arg(line.response));
    if (line.frequency_hz < kLowest_lag_hz || line.frequency_hz > kHighest_lag_hz) continue;
    const double w = kTurn * line.frequency_hz;
    // Each part of a complex number has half of its variance.
    const double error = line.error / (std::numbers::sqrt2 * std::abs(line.response));
    s_ww += w * w;
    s_wp += w * phase;
    noise += w * w * error * error;
    points.push_back({w, phase});
  }
  out.lag_s = s_wp / s_ww;
  double squares = 0.0;
  for (const auto& [w, p] : points) squares += (p - w * out.lag_s) * (p - w * out.lag_s);
  const double misfit = squares / static_cast<double>(points.size() - 1) / s_ww;
  out.lag_error_s = std::sqrt(misfit + noise / (s_ww * s_ww));
}

void find_bandwidth(PlatformResponse& out) {
  const double down = -0.5 * std::numbers::ln2;  // of |H| = 1/sqrt 2
  const double zero = std::log(std::abs(out.lines.front().response));
  const auto level = [&](const PlatformLine& line) {
    return std::log(std::abs(line.response)) - zero;
  };
  out.bandwidth_hz = out.lines.back().frequency_hz;
  for (std::size_t i = 1; i < out.lines.size(); ++i) {
    const PlatformLine& low = out.lines[i - 1];
    const PlatformLine& high = out.lines[i];
    if (level(high) > down) continue;
    if (!(std::abs(high.response) > 0.0)) return;  // no motion there at all: no place between
    const double fall = level(low) - level(high);
    const double u = (level(low) - down) / fall;
    const double octaves = std::log(high.frequency_hz / low.frequency_hz);
    out.bandwidth_hz = low.frequency_hz * std::exp(u * octaves);
    const auto relative = [](const PlatformLine& line) {
      return line.error / (std::numbers::sqrt2 * std::abs(line.response));
    };
    out.bandwidth_error_hz = out.bandwidth_hz * octaves / fall *
                             std::hypot((1.0 - u) * relative(low), u * relative(high));
    out.bandwidth_seen = true;
    return;
  }
}

}  // namespace

PlatformTest::PlatformTest(const PlatformTestLimits& limits, std::int64_t periods)
    : motion_(kPeriod_ticks, kControlRateHz, {}), periods_(periods) {
  for (const double limit :
       {limits.motion_m, limits.max_velocity_m_s, limits.max_acceleration_m_s2}) {
    if (!(limit > 0.0)) {
      throw ConfigError("platform test", fmt::format("a limit of {}", limit), "one above 0");
    }
  }
  if (periods < 2) {
    throw ConfigError("platform test", fmt::format("{} periods", periods), "two at least");
  }
  motion_ = multisine(limits);
  const std::vector<Complex> none(kHarmonics.size());
  sums_.assign(static_cast<std::size_t>(periods), {none, none, none});
}

Tick PlatformTest::ticks() const noexcept {
  return 2 * kRamp_ticks + (periods_ + 1) * kPeriod_ticks;
}

signal::MotionSample PlatformTest::at(Tick tick) const noexcept {
  const signal::MotionSample full = motion_.at(tick);
  constexpr double kLength_s = kControlPeriod_s * static_cast<double>(kRamp_ticks);
  const Tick left = ticks() - 1 - tick;
  const bool falls = left < kRamp_ticks;
  Fade ramp =
      fade(static_cast<double>(falls ? left : tick) / static_cast<double>(kRamp_ticks), kLength_s);
  if (falls) ramp.rate_s = -ramp.rate_s;
  return {
      ramp.value * full.accel_m_s2 + 2.0 * ramp.rate_s * full.vel_m_s + ramp.bend_s2 * full.pos_m,
      ramp.value * full.vel_m_s + ramp.rate_s * full.pos_m, ramp.value * full.pos_m};
}

void PlatformTest::take(Tick tick, double position_m, double seat_m_s2) noexcept {
  const Tick measured = tick - kRamp_ticks - kPeriod_ticks;
  if (measured < 0 || measured >= periods_ * kPeriod_ticks) return;
  if (std::isfinite(position_m)) {
    held_m_ = position_m;
  } else {
    ++missing_;
  }
  if (std::isfinite(seat_m_s2)) {
    held_m_s2_ = seat_m_s2;
    ++seats_;
  }
  Period& period = sums_[static_cast<std::size_t>(measured / kPeriod_ticks)];
  const double set_point_m = at(tick).pos_m;
  for (std::size_t i = 0; i < kHarmonics.size(); ++i) {
    const double turn = static_cast<double>(kHarmonics[i] * measured % kPeriod_ticks) /
                        static_cast<double>(kPeriod_ticks);
    const Complex wave = std::polar(1.0, -kTurn * turn);
    period.set_point[i] += set_point_m * wave;
    period.position[i] += held_m_ * wave;
    period.seat[i] += held_m_s2_ * wave;
  }
}

PlatformResponse PlatformTest::result() const {
  const std::int64_t all = periods_ * kPeriod_ticks;
  if (100 * missing_ > all) {
    throw ConfigError("platform", fmt::format("{} of {} positions missing", missing_, all),
                      "a platform that reports where it is");
  }
  PlatformResponse out;
  for (std::size_t i = 0; i < kHarmonics.size(); ++i) {
    std::vector<Complex> ratios;
    for (const Period& period : sums_) ratios.push_back(period.position[i] / period.set_point[i]);
    const Mean mean = mean_of(ratios);
    out.lines.push_back({frequency_hz(kHarmonics[i]), mean.value, mean.error});
  }
  const PlatformLine& lowest = out.lines.front();
  out.gain = std::abs(lowest.response);
  out.gain_error = lowest.error / std::numbers::sqrt2;
  if (!(out.gain > 0.1)) {
    throw ConfigError("platform",
                      fmt::format("a state that follows {:.2g} of the set-point", out.gain),
                      "a platform that follows");
  }
  fit_lag(out);
  find_bandwidth(out);
  out.seat_seen = 100 * seats_ >= 99 * all;
  if (!out.seat_seen) return out;
  std::vector<Complex> gains;
  for (const Period& period : sums_) {
    double s_bb = 0.0;
    Complex s_ab = 0.0;
    for (std::size_t i = 0; i < kHarmonics.size(); ++i) {
      const double w = kTurn * frequency_hz(kHarmonics[i]);
      const Complex own = -w * w * period.position[i];
      s_bb += std::norm(own);
      s_ab += period.seat[i] * std::conj(own);
    }
    gains.emplace_back(s_ab.real() / s_bb);
  }
  const Mean seat = mean_of(gains);
  out.seat_gain = seat.value.real();
  out.seat_gain_error = seat.error;
  return out;
}

}  // namespace stillhand::device_rig
