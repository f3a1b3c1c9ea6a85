// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/growing_oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::signal {
namespace {

// A change of sign counts where |y| has passed this: the encoder has steps of 1.5 mrad.
constexpr double kHysteresis_rad = 0.002;
constexpr int kOrder = 2;

const OscillationLimits& validated(const OscillationLimits& limits) {
  if (!(limits.floor_rad <= limits.ceiling_rad)) {
    throw ConfigError("oscillation.floor_rad", std::to_string(limits.floor_rad),
                      "at most ceiling_rad, " + std::to_string(limits.ceiling_rad));
  }
  if (!(limits.low_hz < limits.high_hz)) {
    throw ConfigError("oscillation.low_hz", std::to_string(limits.low_hz),
                      "less than high_hz, " + std::to_string(limits.high_hz));
  }
  return limits;
}

Tick half_period(double frequency_hz) noexcept { return ticks_in(0.5 / frequency_hz); }

}  // namespace

GrowingOscillation::GrowingOscillation(const OscillationLimits& limits)
    : limits_(validated(limits)),
      high_pass_(kOrder, 0.5 * limits.low_hz, kControlRateHz, Passband::kHigh),
      low_pass_(kOrder, 4.0 * limits.high_hz, kControlRateHz),
      longest_(half_period(limits.low_hz)),
      shortest_(half_period(limits.high_hz)) {}

void GrowingOscillation::reset() noexcept {
  high_pass_.reset();
  low_pass_.reset();
  past_ = {};
  now_ = {};
  sign_ = last_rad_ = frequency_hz_ = 0.0;
  started_ = found_ = false;
}

bool GrowingOscillation::in_band() const noexcept {
  return std::ranges::all_of(past_, [this](const HalfWave& half) {
    return half.ticks >= shortest_ && half.ticks <= longest_;
  });
}

bool GrowingOscillation::regular() const noexcept {
  const auto [shortest, longest] = std::ranges::minmax(past_, {}, &HalfWave::ticks);
  return static_cast<double>(longest.ticks) <=
         limits_.regularity * static_cast<double>(shortest.ticks);
}

// Eq. VH-7.
bool GrowingOscillation::grows() const noexcept {
  return regular() && now_.peak_rad >= limits_.floor_rad &&
         now_.peak_rad >= limits_.growth * past_[0].peak_rad &&
         past_[0].peak_rad >= limits_.growth * past_[1].peak_rad &&
         past_[1].peak_rad >= limits_.growth * past_[2].peak_rad;
}

// Eq. VH-8.
bool GrowingOscillation::too_large() const noexcept {
  return now_.peak_rad >= limits_.ceiling_rad && past_[0].peak_rad >= limits_.ceiling_rad &&
         past_[1].peak_rad >= limits_.ceiling_rad;
}

void GrowingOscillation::next_half_wave() noexcept {
  past_[2] = past_[1];
  past_[1] = past_[0];
  past_[0] = now_;
  now_ = {};
}

bool GrowingOscillation::step(double theta_rad) noexcept {
  if (std::isfinite(theta_rad)) last_rad_ = std::clamp(theta_rad, -1.6, 1.6);
  if (!started_) {
    started_ = true;
    rest_rad_ = last_rad_;
  }
  const double y = low_pass_.step(high_pass_.step(last_rad_ - rest_rad_));
  const double side = y > kHysteresis_rad ? 1.0 : (y < -kHysteresis_rad ? -1.0 : 0.0);
  if (side != 0.0 && side != sign_) {
    if (sign_ != 0.0) next_half_wave();
    sign_ = side;
  }
  now_.ticks = std::min(now_.ticks + 1, longest_ + 1);
  now_.peak_rad = std::max(now_.peak_rad, std::abs(y));
  if (!found_ && in_band() && (grows() || too_large())) {
    found_ = true;
    frequency_hz_ = kControlRateHz / static_cast<double>(past_[0].ticks + past_[1].ticks);
  }
  return found_;
}

}  // namespace stillhand::signal
