// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/scene.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stillhand::planted {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kCursorPerStick_m_rad = 0.6;

Series noise_between(const Grid& grid, double low_hz, double high_hz, double rms, Draw& draw) {
  const double slowest_hz = low_hz > 0.0 ? low_hz : high_hz;
  const auto settle = static_cast<std::size_t>(3.0 / slowest_hz * grid.rate_hz);
  Series out(settle + grid.size);
  for (double& value : out) value = draw.normal();
  if (low_hz > 0.0) high_pass(out, grid.rate_hz, low_hz, 2);
  low_pass(out, grid.rate_hz, high_hz, 2);
  low_pass(out, grid.rate_hz, high_hz, 2);
  out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(settle));
  standardise(out, rms);
  return out;
}

/// Own noise plus a share of another signal, at the given root mean square.
Series partly_like(Series own, const Series& other, double correlation, double rms) {
  standardise(own, std::sqrt(1.0 - correlation * correlation));
  const double scale = correlation / spread_of(other);
  for (std::size_t i = 0; i < own.size(); ++i) own[i] += scale * other[i];
  standardise(own, rms);
  return own;
}

Series target(const Grid& grid, Draw& draw, std::vector<double>& lines_hz) {
  Series out(grid.size, 0.0);
  double line_hz = draw.uniform(0.015, 0.03);
  for (int k = 0; k < 9 && line_hz < 0.6; ++k) {
    const double amplitude = std::exp(-0.14 * k);
    const double phase_rad = draw.uniform(0.0, kTwoPi);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] += amplitude * std::sin(kTwoPi * line_hz * grid.time_s(i) + phase_rad);
    }
    lines_hz.push_back(line_hz);
    line_hz *= draw.uniform(1.25, 1.7);
  }
  standardise(out, draw.uniform(0.06, 0.08));
  return out;
}

/// The hand follows the target late, softly and not quite: [rad].
Series stick_angle(const Grid& grid, const Series& target_m, Draw& draw) {
  Series out(target_m.size());
  const auto delay = static_cast<std::size_t>(draw.uniform(0.15, 0.35) * grid.rate_hz);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = target_m[i > delay ? i - delay : 0] / kCursorPerStick_m_rad;
  }
  low_pass(out, grid.rate_hz, draw.uniform(0.5, 1.0), 2);
  const Series remnant =
      noise_between(grid, 0.05, draw.uniform(0.5, 1.0), draw.uniform(0.01, 0.03), draw);
  double largest = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] += remnant[i];
    largest = std::max(largest, std::abs(out[i]));
  }
  // The stick has +-30 degrees; tracking keeps within 0.3 rad.
  for (double& value : out) value *= std::min(1.0, 0.3 / largest);
  return out;
}

Series rate_of(const Series& values, double rate_hz) {
  Series out(values.size(), 0.0);
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    out[i] = 0.5 * rate_hz * (values[i + 1] - values[i - 1]);
  }
  return out;
}

/// Warm-up with a thermostat's waves and a little wandering [degC].
Series temperature(const Grid& grid, double length_s, Draw& draw, std::vector<double>& lines_hz) {
  const double start_degc = draw.uniform(18.0, 26.0);
  const double rise_k = draw.uniform(2.0, 8.0);
  const double tau_s = length_s * draw.uniform(0.2, 1.0);
  const double wave_hz = 1.0 / (length_s * draw.uniform(0.12, 0.3));
  const double wave_k = rise_k * draw.uniform(0.08, 0.2);
  const double phase_rad = draw.uniform(0.0, kTwoPi);
  const Series wander = noise_between(grid, 0.0, 0.1, 0.02 * rise_k, draw);
  Series out(grid.size);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double t_s = std::max(0.0, grid.time_s(i));
    out[i] = start_degc + rise_k * (1.0 - std::exp(-t_s / tau_s)) +
             wave_k * std::sin(kTwoPi * wave_hz * grid.time_s(i) + phase_rad) + wander[i];
  }
  lines_hz.push_back(wave_hz);
  return out;
}

Series grip_force(const Grid& grid, Draw& draw) {
  const double mean_n = draw.uniform(8.0, 20.0);
  Series out = noise_between(grid, 0.03, draw.uniform(0.2, 0.4), draw.uniform(0.15, 0.3), draw);
  for (double& value : out) value = mean_n * std::exp(value);  // positive by nature
  return out;
}

}  // namespace

const Series& Scene::of(std::string_view name) const {
  for (const Signal& signal : signals) {
    if (signal.name == name) return signal.values;
  }
  throw std::invalid_argument("no signal called " + std::string(name));
}

Scene draw_scene(Draw& draw, double length_s, double rate_hz, const Excitation& excitation) {
  Scene scene{Grid(length_s, rate_hz), excitation, {}, excitation.lines_hz, {}};
  scene.identity = std::make_shared<const int>(0);
  const Grid& grid = scene.grid;
  const auto add = [&](const char* name, const char* unit, Series values) {
    scene.signals.push_back({name, unit, std::move(values)});
  };
  const Series a_y = acceleration(excitation, grid, draw);
  Series a_x = partly_like(noise_between(grid, 0.3, draw.uniform(2.0, 6.0), 1.0, draw), a_y,
                           draw.uniform(0.0, 0.3), draw.uniform(0.3, 0.9));
  Series a_z = partly_like(noise_between(grid, 0.7, draw.uniform(4.0, 10.0), 1.0, draw), a_y,
                           draw.uniform(0.0, 0.15), draw.uniform(0.3, 1.0));
  Series sway = a_y;
  lag(sway, grid.rate_hz, draw.uniform(0.1, 0.3));
  Series roll = partly_like(noise_between(grid, 0.05, draw.uniform(0.3, 1.5), 1.0, draw), sway,
                            draw.uniform(0.0, 0.4), draw.uniform(0.01, 0.04));
  Series x_r = target(grid, draw, scene.periodic_hz);
  Series theta = stick_angle(grid, x_r, draw);
  Series omega = rate_of(theta, grid.rate_hz);
  Series x_p(theta.size());
  const auto latency = static_cast<std::size_t>(draw.uniform(0.015, 0.04) * grid.rate_hz);
  for (std::size_t i = 0; i < x_p.size(); ++i) {
    x_p[i] = kCursorPerStick_m_rad * theta[i > latency ? i - latency : 0];
  }
  add("a_y", "m/s^2", a_y);
  add("a_x", "m/s^2", std::move(a_x));
  add("a_z", "m/s^2", std::move(a_z));
  add("roll", "rad", std::move(roll));
  add("theta", "rad", std::move(theta));
  add("omega", "rad/s", std::move(omega));
  add("x_r", "m", std::move(x_r));
  add("x_p", "m", std::move(x_p));
  add("temp", "degC", temperature(grid, length_s, draw, scene.periodic_hz));
  add("grip", "N", grip_force(grid, draw));
  return scene;
}

}  // namespace stillhand::planted
