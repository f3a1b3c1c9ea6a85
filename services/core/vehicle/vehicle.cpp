// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/vehicle.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::vehicle {
namespace {

constexpr double kDt_s = kControlPeriod_s;

const VehicleConfig& validated(const VehicleConfig& config) {
  validate(config, "vehicle");
  return config;
}

// d0, d1, d2 of (s^2 + 2 z w s + w^2)(s + w_c), Eq. VH-4.
std::array<double, 3> washout_terms(const Washout& washout) noexcept {
  const double w = kTwoPi * washout.natural_hz;
  const double damping = 2.0 * washout.damping_ratio * w;
  const double centring = kTwoPi * washout.centring_hz;
  return {w * w * centring, w * w + damping * centring, damping + centring};
}

// The command waits in the core for what the lead does not cover.
std::size_t waiting_ticks(const VehicleConfig& config) noexcept {
  return static_cast<std::size_t>(
      std::max<std::int64_t>(ticks_in(config.delay_s) - kLead_ticks, 0));
}

}  // namespace

Vehicle::Vehicle(const VehicleConfig& config)
    : config_(validated(config)),
      delay_(waiting_ticks(config)),
      second_(kTwoPi * config.natural_hz, config.damping_ratio, kDt_s),
      keep_(std::exp(-kDt_s / config.lag_s)) {
  const auto terms = washout_terms(config.washout);
  d0_ = terms[0];
  d1_ = terms[1];
  d2_ = terms[2];
}

void Vehicle::reset() noexcept {
  delay_.reset();
  second_.reset();
  first_m_s2_ = centring_m_s_ = held_rad_ = 0.0;
  absent_ = 0;
}

double Vehicle::stick(const VehicleInput& input, Flags& flags) noexcept {
  if (input.sound && std::isfinite(input.theta_rad)) {
    absent_ = 0;
    held_rad_ = std::clamp(input.theta_rad, -config_.max_stick_rad, config_.max_stick_rad);
  } else {
    flags |= kInputStale;
    if (++absent_ > config_.max_hold_ticks) held_rad_ = 0.0;
    absent_ = std::min(absent_, config_.max_hold_ticks + 1);
  }
  return held_rad_;
}

// Eqs. VH-2 and VH-3.
double Vehicle::vehicle_acceleration(double command_m_s2) noexcept {
  if (config_.order == 2) {
    const auto state = second_.step(command_m_s2);
    if (!config_.speed_follows) return state.x;
    return 2.0 * config_.damping_ratio / (kTwoPi * config_.natural_hz) * state.v;
  }
  first_m_s2_ = command_m_s2 + keep_ * (first_m_s2_ - command_m_s2);
  return config_.speed_follows ? command_m_s2 - first_m_s2_ : first_m_s2_;
}

VehicleMotion Vehicle::step(const VehicleInput& input) noexcept {
  VehicleMotion out;
  const double bound = config_.max_acceleration_m_s2;
  const double share = input.share > 0.0 ? std::min(input.share, 1.0) : 0.0;
  const double command = delay_.step(config_.gain_m_s2_rad * stick(input, out.flags) * share);
  const double wanted = vehicle_acceleration(command);
  const double x = input.platform_position_m;
  const double v = input.platform_velocity_m_s;
  const double room = d0_ > 0.0 ? bound / d0_ : 0.0;  // the integral never asks for more than |a|
  centring_m_s_ = std::clamp(centring_m_s_ + x * kDt_s, -room, room);
  const double free = wanted - d2_ * v - d1_ * x - d0_ * centring_m_s_;
  const double a = std::clamp(free, -bound, bound);
  if (a != free) out.flags |= kSaturated;
  out.acceleration_m_s2 = a;
  out.velocity_m_s = v + a * kDt_s;
  out.position_m = x + v * kDt_s + 0.5 * a * kDt_s * kDt_s;
  return out;
}

std::complex<double> vehicle_response(const VehicleConfig& config, double frequency_hz) noexcept {
  using Complex = std::complex<double>;
  const double w = kTwoPi * frequency_hz;
  const Complex back = std::polar(1.0, -w * kDt_s);  // one tick
  const Complex s{0.0, w};
  Complex lag;
  if (config.order == 2) {
    const double natural = kTwoPi * config.natural_hz;
    const Complex bottom = s * s + 2.0 * config.damping_ratio * natural * s + natural * natural;
    lag = (config.speed_follows ? 2.0 * config.damping_ratio * natural * s : natural * natural) /
          bottom;
    lag *= std::polar(1.0, -0.5 * w * kDt_s);  // an input held over the tick
  } else {
    const double keep = std::exp(-kDt_s / config.lag_s);
    const Complex low = (1.0 - keep) / (1.0 - keep * back);
    lag = config.speed_follows ? 1.0 - low : low;
  }
  // Recursion of VH-4, VH-5: x = dt^2/2 (z^-1 + z^-2)/(1 - z^-1)^2 z a, and so on.
  const Complex step = 1.0 - back;
  const Complex velocity = kDt_s * back / step;  // before the tick, per a
  const Complex position = 0.5 * kDt_s * kDt_s * back * (1.0 + back) / (step * step);
  const Complex integral = kDt_s * position / step;
  const auto [d0, d1, d2] = washout_terms(config.washout);
  const Complex washout = 1.0 / (1.0 + d2 * velocity + d1 * position + d0 * integral);
  const auto late = static_cast<double>(std::max(ticks_in(config.delay_s), kLead_ticks));
  return config.gain_m_s2_rad * std::polar(1.0, -w * kDt_s * late) * lag * washout;
}

}  // namespace stillhand::vehicle
