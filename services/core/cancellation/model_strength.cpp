// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_strength.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "services/core/cancellation/value_table.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"

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

// Largest magnitude of a map on a range about 0: it is straight between its values, so that the
// ends of the range and the values within it are enough.
double largest_of(const ValueMap& map, double range) {
  const ValueTable table(map);
  double most = std::max(std::abs(table(-range)), std::abs(table(range)));
  const auto count = map.values.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double at =
        map.low + (map.high - map.low) * static_cast<double>(i) / static_cast<double>(count - 1);
    if (std::abs(at) <= range) most = std::max(most, std::abs(map.values[i]));
  }
  return most;
}

// Largest force of a path next to the body, on its channel's whole range; behind an element with
// memory, on that of w.
double greatest(const DirectPath& path, const Hysteresis* memory) {
  return std::abs(path.gain) *
         largest_of(path.map, memory != nullptr ? 1.0 : full_scale(path.channel));
}

// What a spring with memory holds at rest at most: w = 1 over the body's stiffness.
double held_by_spring(const ControlModel& model) {
  if (!model.loop || hysteresis_of(model, {}) == nullptr) return 0.0;
  const auto sum = [](const std::vector<double>& c) {
    return std::accumulate(c.begin(), c.end(), 0.0);
  };
  return std::abs(sum(model.loop->e) / sum(model.denominator)) * largest_of(model.loop->phi, 1.0);
}

bool of_stick(Channel channel) { return channel == Channel::kTheta || channel == Channel::kOmega; }

// Largest |H| from a channel.  The platform's accelerations are alike, and its roll tips gravity
// over; a path from the stick is bounded by the force at its full scale.
double gain_bound(Channel channel, const ModelBounds& bounds) {
  if (of_stick(channel)) return bounds.max_path_force_n / full_scale(channel);
  return bounds.max_gain_n_s2_m * (channel == Channel::kRoll ? kGravity_m_s2 : 1.0);
}

// What a path may ask for at most, in the terms of gain_bound().  However steep an element with
// memory is, it asks for no more than its ends.
double gain_of(const DirectPath& path, const Hysteresis* memory) {
  if (of_stick(path.channel) || memory != nullptr) {
    return greatest(path, memory) / full_scale(path.channel);
  }
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

Slopes slopes_of(const ValueMap& map, const Hysteresis* memory) {
  const Slopes slopes = slopes_of(map);
  if (memory == nullptr) return slopes;
  const double steepest = signal::steepest_slope(memory->operation) / memory->threshold;
  const auto [least, most] = std::minmax({0.0, steepest * slopes.least, steepest * slopes.most});
  return {least, most};
}

Refusal check_strength(const ControlModel& model, const std::vector<std::complex<double>>& poles,
                       const ModelBounds& bounds) {
  const double behind = slopes_of(model.output).steepest();
  std::array<double, kChannels> gains{};
  for (const InputPath& input : model.inputs) {
    gains[static_cast<std::size_t>(input.channel)] +=
        peak_gain(path_model(model, input), poles) * slopes_of(input.map).steepest() * behind;
  }
  double at_rest_n = held_by_spring(model) * behind;
  for (std::size_t i = 0; i < model.paths.size(); ++i) {
    const DirectPath& path = model.paths[i];
    const Hysteresis* memory = hysteresis_of(model, i);
    gains[static_cast<std::size_t>(path.channel)] += gain_of(path, memory);
    if (memory != nullptr) at_rest_n += greatest(path, memory);
  }
  // Written so that a NaN is refused, too.
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    if (gains[i] <= gain_bound(channel, bounds)) continue;
    return channel == Channel::kAccelY ? Refusal::kGain : Refusal::kPath;
  }
  for (const Wave& wave : model.waves) at_rest_n += std::hypot(wave.sine_n, wave.cosine_n);
  return at_rest_n <= bounds.max_path_force_n ? Refusal::kNone : Refusal::kPath;
}

}  // namespace stillhand::cancellation
