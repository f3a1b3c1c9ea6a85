// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/model_strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/cancellation/core/value_table.hpp"
#include "services/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

// Largest |H| found; NaN when any value isn't finite.
double peak_gain(const signal::DifferenceModel& model,
                 const std::vector<std::complex<double>>& poles) {
  double peak = 0.0;
  const auto look = [&](double frequency_hz) {
    const double gain = std::abs(signal::response_at(model, frequency_hz));
    if (!(gain <= peak)) peak = gain;
  };
  constexpr int kPoints = 400;
  look(0.0);
  for (int i = 0; i <= kPoints && std::isfinite(peak); ++i) {
    // From 0.01 Hz up, evenly in log frequency: 85 a decade.
    look(0.01 * std::pow(0.5 * model.rate_hz / 0.01, static_cast<double>(i) / kPoints));
  }
  for (const std::complex<double>& pole : poles) {
    if (!std::isfinite(peak)) break;
    look(std::abs(std::arg(pole)) * model.rate_hz / (2.0 * std::numbers::pi));
  }
  return peak;
}

double full_scale(Channel channel) {
  return kChannelFacts[static_cast<std::size_t>(channel)].full_scale;
}

// Largest force of a path next to the body, on its channel's whole range.
double greatest(const DirectPath& path) {
  const ValueTable map(path.map);
  constexpr int kPoints = 1000;
  double most = 0.0;
  for (int i = -kPoints; i <= kPoints; ++i) {
    const double value = map(full_scale(path.channel) * i / kPoints);
    most = std::max(most, std::abs(path.gain * value));
  }
  return most;
}

bool of_stick(Channel channel) { return channel == Channel::kTheta || channel == Channel::kOmega; }

// Largest |H| from a channel.  The platform's accelerations are alike, and its roll tips gravity
// over; a path from the stick is bounded by the force at its full scale.
double gain_bound(Channel channel, const ModelBounds& bounds) {
  constexpr double kGravity_m_s2 = 9.80665;
  if (of_stick(channel)) return bounds.max_path_force_n / full_scale(channel);
  return bounds.max_gain_n_s2_m * (channel == Channel::kRoll ? kGravity_m_s2 : 1.0);
}

// What a path may ask for at most, in the terms of gain_bound().
double gain_of(const DirectPath& path) {
  if (of_stick(path.channel)) return greatest(path) / full_scale(path.channel);
  return std::abs(path.gain) * slopes_of(path.map).steepest();
}

}  // namespace

Slopes slopes_of(const ValueMap& map) {
  if (map.values.empty()) return {1.0, 1.0};
  const double step = (map.high - map.low) / static_cast<double>(map.values.size() - 1);
  Slopes slopes{HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 1; i < map.values.size(); ++i) {
    const double slope = (map.values[i] - map.values[i - 1]) / step;
    slopes.least = std::min(slopes.least, slope);
    slopes.most = std::max(slopes.most, slope);
  }
  return slopes;
}

Refusal check_strength(const ControlModel& model, const std::vector<std::complex<double>>& poles,
                       const ModelBounds& bounds) {
  const double behind = slopes_of(model.output).steepest();
  std::array<double, kChannels> gains{};
  for (const InputPath& input : model.inputs) {
    gains[static_cast<std::size_t>(input.channel)] +=
        peak_gain(path_model(model, input), poles) * slopes_of(input.map).steepest() * behind;
  }
  for (const DirectPath& path : model.paths) {
    gains[static_cast<std::size_t>(path.channel)] += gain_of(path);
  }
  // Written so that a NaN is refused, too.
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    if (gains[i] <= gain_bound(channel, bounds)) continue;
    return channel == Channel::kAccelY ? Refusal::kGain : Refusal::kPath;
  }
  double waves_n = 0.0;
  for (const Wave& wave : model.waves) waves_n += std::hypot(wave.sine_n, wave.cosine_n);
  return waves_n <= bounds.max_path_force_n ? Refusal::kNone : Refusal::kPath;
}

}  // namespace stillhand::cancellation
