// SPDX-License-Identifier: Apache-2.0
#include "services/core/sensing/conditioner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillhand::sensing {
namespace {

/// A reading within one 16-bit code of the end of the range counts as clipped.
constexpr double kRail = 1.0 - 1.0 / 32768.0;
/// The same limit for an accelerometer, whose clipped output still has noise.
constexpr double kSensorEnd = 0.99;

const Config& checked(const Config& config) {
  validate(config, "sensing");
  return config;
}

}  // namespace

Conditioner::Conditioner(const Config& config)
    : config_(checked(config)),
      accel_m_s2_per_v_(1.0 / config.accel_sensitivity_v_m_s2),
      force_n_per_v_(1.0 / config.load_cell_sensitivity_v_n),
      rad_per_count_(2.0 * std::numbers::pi / config.encoder_counts_per_rev),
      antialias_{{{2, config.antialias_cutoff_hz, kControlRateHz},
                  {2, config.antialias_cutoff_hz, kControlRateHz},
                  {2, config.antialias_cutoff_hz, kControlRateHz},
                  {2, config.antialias_cutoff_hz, kControlRateHz}}},
      rate_filter_(2, config.rate_cutoff_hz, kControlRateHz) {}

double Conditioner::in_units(double volts, double offset_v, double units_per_v, double held,
                             Flags& flags) const noexcept {
  if (!std::isfinite(volts)) {
    flags |= kInputInvalid;
    return held;
  }
  if (std::abs(volts) >= config_.adc_range_v * kRail) flags |= kSaturated;
  const double inside_v = std::clamp(volts, -config_.adc_range_v, config_.adc_range_v);
  return (inside_v - offset_v) * units_per_v;
}

double Conditioner::angle(std::int64_t counts, Flags& flags) const noexcept {
  const double from_zero =
      static_cast<double>(counts) - static_cast<double>(config_.encoder_zero_counts);
  // Between its stops the stick moves less than a quarter turn; half a turn is a counter fault.
  if (std::abs(from_zero) > 0.5 * config_.encoder_counts_per_rev) {
    flags |= kInputInvalid;
    return last_.theta_rad;
  }
  return from_zero * rad_per_count_;
}

Conditioner::Calibrated Conditioner::calibrated(const DeviceSample& sample,
                                                Flags& flags) const noexcept {
  const auto accel = [&](double volts, double offset_v, double held) {
    const double a_m_s2 = in_units(volts, offset_v, accel_m_s2_per_v_, held, flags);
    if (std::abs(a_m_s2) >= config_.accel_range_m_s2 * kSensorEnd) flags |= kSaturated;
    return a_m_s2;
  };
  Calibrated now;
  now.analog = {accel(sample.accel_x_v, config_.accel_x_offset_v, last_.analog[0]),
                accel(sample.accel_y_v, config_.accel_y_offset_v, last_.analog[1]),
                accel(sample.accel_z_v, config_.accel_z_offset_v, last_.analog[2]),
                in_units(sample.load_cell_v, config_.load_cell_offset_v, force_n_per_v_,
                         last_.analog[3], flags)};
  now.theta_rad = angle(sample.encoder_counts, flags);
  now.roll_rad = sample.roll_rad;
  if (!(std::abs(sample.roll_rad) <= std::numbers::pi)) {
    flags |= kInputInvalid;
    now.roll_rad = last_.roll_rad;
  }
  return now;
}

void Conditioner::settle(const Calibrated& now) noexcept {
  baseline_ = now.analog;
  for (auto& filter : antialias_) filter.reset();
  rate_filter_.reset();
  last_ = now;
}

void Conditioner::bridge(const Calibrated& now, Tick lost_ticks) noexcept {
  const Calibrated before = last_;
  for (Tick k = 1; k <= lost_ticks; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(lost_ticks + 1);
    Calibrated between = before;
    for (std::size_t i = 0; i < kAnalogChannels; ++i) {
      between.analog[i] += share * (now.analog[i] - before.analog[i]);
    }
    between.theta_rad += share * (now.theta_rad - before.theta_rad);
    advance(between);
  }
}

void Conditioner::advance(const Calibrated& now) noexcept {
  // The gain at 0 Hz is 1, so filtering the deviation from a baseline equals filtering the signal.
  // A filter at rest has settled at the baseline (Eq. SE-2).
  std::array<double, kAnalogChannels> filtered;
  for (std::size_t i = 0; i < kAnalogChannels; ++i) {
    filtered[i] = baseline_[i] + antialias_[i].step(now.analog[i] - baseline_[i]);
  }
  out_.accel_x_m_s2 = filtered[0];
  out_.accel_y_m_s2 = filtered[1];
  out_.accel_z_m_s2 = filtered[2];
  out_.force_n = filtered[3];
  out_.omega_rad_s = rate_filter_.step((now.theta_rad - last_.theta_rad) * kControlRateHz);
  out_.theta_rad = now.theta_rad;
  out_.roll_rad = now.roll_rad;
  last_ = now;
}

Sensed Conditioner::step(const DeviceSample& sample) noexcept {
  const Tick restart_ticks = config_.max_bridged_ticks;
  const bool behind = started_ && sample.tick <= last_tick_;
  if (sample.tick < 0 || (behind && last_tick_ - sample.tick <= restart_ticks)) {
    Sensed repeated = out_;
    repeated.flags = kInputInvalid;
    return repeated;
  }
  Flags flags = kGood;
  const Calibrated now = calibrated(sample, flags);
  const Tick lost_ticks = started_ && !behind ? sample.tick - last_tick_ - 1 : 0;
  if (lost_ticks > 0 || behind) flags |= kInputGap;
  if (!started_ || behind || lost_ticks > config_.max_bridged_ticks) {
    settle(now);
  } else if (lost_ticks > 0) {
    bridge(now, lost_ticks);
  }
  advance(now);
  out_.flags = flags;
  last_tick_ = sample.tick;
  started_ = true;
  return out_;
}

}  // namespace stillhand::sensing
