// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/interleaved_multisines.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::admittance {
namespace {

// Streams of the seed.
constexpr std::uint64_t kForcePhases = 0xAD01;
constexpr std::uint64_t kMotionPhases = 0xAD02;

std::int64_t samples_of(const ExcitationConfig& config) {
  return std::llround(config.period_s * config.rate_hz);
}

void check(const ExcitationConfig& config) {
  validate(config, "excitation");
  const double samples = config.period_s * config.rate_hz;
  if (std::abs(samples - std::round(samples)) > 1e-6) {
    throw ConfigError("excitation.period_s", std::to_string(samples) + " samples",
                      "a whole number of samples");
  }
  if (!(config.highest_hz < 0.4 * config.rate_hz) || !(config.lowest_hz < config.highest_hz)) {
    throw ConfigError("excitation.highest_hz", std::to_string(config.highest_hz),
                      "more than lowest_hz and less than 0.4 of rate_hz");
  }
  if (config.lowest_hz * config.period_s < 1.0 - 1e-9) {
    throw ConfigError("excitation.lowest_hz", std::to_string(config.lowest_hz),
                      "at least one cycle in period_s");
  }
}

// Eq. AD-2.
double amplitude(const LineShape& shape, double frequency_hz) {
  const double low = std::min(1.0, frequency_hz / shape.low_corner_hz);
  const double high = std::min(1.0, shape.high_corner_hz / frequency_hz);
  return std::pow(low, shape.low_slope) * std::pow(high, shape.high_slope);
}

std::vector<double> phases(const ExcitationConfig& config, std::uint64_t stream,
                           const std::vector<double>& amplitudes) {
  if (config.schroeder) return signal::schroeder_phases(amplitudes);
  signal::Gaussian draw(static_cast<std::uint64_t>(config.seed), stream);
  std::vector<double> out;
  for (std::size_t i = 0; i < amplitudes.size(); ++i) out.push_back(kTwoPi * draw.uniform());
  return out;
}

// Bound over peak, Eq. AD-3.
double room(const signal::Multisine& sine, double accel_bound, double position_bound) {
  double accel = 0.0;
  double position = 0.0;
  for (std::int64_t n = 0; n < sine.samples_per_period(); ++n) {
    const signal::MotionSample sample = sine.at(n);
    accel = std::max(accel, std::abs(sample.accel_m_s2));
    position = std::max(position, std::abs(sample.pos_m));
  }
  const double between =
      std::cos(std::numbers::pi * static_cast<double>(sine.components().back().harmonic) /
               static_cast<double>(sine.samples_per_period()));
  return between * std::min(accel_bound / accel, position_bound / position);
}

signal::Multisine scaled(const ExcitationConfig& config, const LineShape& shape,
                         const std::vector<std::int64_t>& harmonics, std::uint64_t stream,
                         double accel_bound, double position_bound) {
  std::vector<double> amplitudes;
  amplitudes.reserve(harmonics.size());
  for (const std::int64_t k : harmonics) {
    amplitudes.push_back(amplitude(shape, static_cast<double>(k) / config.period_s));
  }
  const std::vector<double> phases_rad = phases(config, stream, amplitudes);
  std::vector<signal::Component> components;
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    components.push_back({harmonics[i], amplitudes[i], phases_rad[i]});
  }
  const signal::Multisine unit(samples_of(config), config.rate_hz, components);
  const double scale = room(unit, accel_bound, position_bound);
  for (signal::Component& component : components) component.amplitude_m_s2 *= scale;
  return {samples_of(config), config.rate_hz, components};
}

}  // namespace

std::vector<std::int64_t> interleaved_harmonics(const ExcitationConfig& config) {
  check(config);
  const std::int64_t count = 2 * config.lines;
  const double ratio = config.highest_hz / config.lowest_hz;
  std::vector<std::int64_t> harmonics;
  for (std::int64_t i = 0; i < count; ++i) {
    const double place = static_cast<double>(i) / static_cast<double>(count - 1);
    const double cycles = config.lowest_hz * std::pow(ratio, place) * config.period_s;
    const auto below = static_cast<std::int64_t>(std::floor(0.5 * (cycles + 1e-9 - 1.0)));
    const std::int64_t odd = 2 * below + 1;
    harmonics.push_back(harmonics.empty() ? odd : std::max(odd, harmonics.back() + 2));
  }
  const double top = config.highest_hz * config.period_s;
  if (static_cast<double>(harmonics.back()) > top + 1e-9) {
    throw ConfigError("excitation.lines", std::to_string(config.lines),
                      "fewer lines, or a longer period_s: the band has no room for two sets of "
                      "odd harmonics");
  }
  return harmonics;
}

Excitation design(const ExcitationConfig& config) {
  const std::vector<std::int64_t> all = interleaved_harmonics(config);
  std::vector<std::int64_t> of_force;
  std::vector<std::int64_t> of_motion;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ((i % 2 == 0) != config.swapped ? of_force : of_motion).push_back(all[i]);
  }
  constexpr double kNoBound = 1e300;
  return {scaled(config, config.force, of_force, kForcePhases, config.peak_force_n, kNoBound),
          scaled(config, config.motion, of_motion, kMotionPhases, config.peak_acceleration_m_s2,
                 config.peak_position_m)};
}

}  // namespace stillhand::admittance
