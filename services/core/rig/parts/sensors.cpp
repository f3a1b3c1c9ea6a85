// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/contract/tick.hpp"

namespace stillhand::rig {
namespace {

/// Stream of the rig's seed for the sensors.
constexpr std::uint64_t kSensorStream = 0x5e45;

/// Nearest integer, halves away from zero; |x| below 2^62.
std::int64_t nearest(double x) noexcept {
  return static_cast<std::int64_t>(x + std::copysign(0.5, x));
}

}  // namespace

Sensors::Sensors(const SensorConfig& config, std::uint64_t seed)
    : config_(config), noise_(seed, kSensorStream) {
  validate(config, "rig.sensors");
  adc_step_v_ = 2.0 * config.adc_range_v / std::exp2(static_cast<double>(config.adc_bits));
  codes_per_v_ = 1.0 / adc_step_v_;
  // White noise of density D sampled at f_s: variance D^2 f_s / 2.
  const double root_band = std::sqrt(kControlRateHz / 2.0);
  accel_noise_v_ = config.accel_noise_m_s2_rthz * root_band * config.accel_sensitivity_v_m_s2;
  load_cell_noise_v_ = config.load_cell_noise_n_rthz * root_band * config.load_cell_sensitivity_v_n;
  counts_per_rad_ = static_cast<double>(config.encoder_counts_per_rev) / (2.0 * std::numbers::pi);
}

double Sensors::converted(double volts, Flags& flags) const noexcept {
  const double highest_v = config_.adc_range_v - adc_step_v_;
  if (volts < -config_.adc_range_v || volts > highest_v) flags |= kSaturated;
  const double inside_v = std::clamp(volts, -config_.adc_range_v, highest_v);
  return static_cast<double>(nearest(inside_v * codes_per_v_)) * adc_step_v_;
}

double Sensors::accelerometer(double accel_m_s2, Flags& flags) noexcept {
  const double inside_m_s2 =
      std::clamp(accel_m_s2, -config_.accel_range_m_s2, config_.accel_range_m_s2);
  if (inside_m_s2 != accel_m_s2) flags |= kSaturated;
  return converted(inside_m_s2 * config_.accel_sensitivity_v_m_s2 + config_.accel_offset_v +
                       accel_noise_v_ * noise_(),
                   flags);
}

Sensors::Output Sensors::step(const SensorInput& input) noexcept {
  Output out{{}, kGood};
  out.raw.accel_x_v = accelerometer(input.accel_x_m_s2, out.flags);
  out.raw.accel_y_v = accelerometer(input.accel_y_m_s2, out.flags);
  out.raw.accel_z_v = accelerometer(input.accel_z_m_s2, out.flags);
  out.raw.load_cell_v = converted(input.force_n * config_.load_cell_sensitivity_v_n +
                                      config_.load_cell_offset_v + load_cell_noise_v_ * noise_(),
                                  out.flags);
  out.raw.encoder_counts = nearest(input.theta_rad * counts_per_rad_);
  out.raw.roll_rad = static_cast<double>(nearest(input.roll_rad / config_.inclinometer_step_rad)) *
                     config_.inclinometer_step_rad;
  return out;
}

}  // namespace stillhand::rig
