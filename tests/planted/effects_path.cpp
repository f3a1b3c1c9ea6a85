// SPDX-License-Identifier: Apache-2.0
// What sits in the drive, the load cell or the clocks: limits, gains, delays.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/planted/effect.hpp"

namespace stillhand::planted {
namespace {

double between(double size, double least, double most) {
  return least * std::pow(most / least, size);
}

/// Applies a function of the instantaneous value.
Stage memoryless(std::function<double(double)> law) {
  return [law = std::move(law)](const Scene&, Series& values) {
    for (double& value : values) value = law(value);
  };
}

std::function<double(double)> limit(bool hard, double level) {
  if (hard) return [level](double x) { return std::clamp(x, -level, level); };
  return [level](double x) { return level * std::tanh(x / level); };
}

std::function<double(double)> threshold(double width) {
  return [width](double x) { return std::abs(x) <= width ? 0.0 : x - std::copysign(width, x); };
}

/// Shape over the recording, mean about 0, largest about 1.
std::function<double(double)> slow_shape(double length_s, Draw& draw, std::string& name) {
  const double sign = draw.sign();
  const std::size_t pick = draw.index(3);
  if (pick == 0) {
    name = "ramp";
    return [=](double t_s) { return sign * (2.0 * std::clamp(t_s / length_s, 0.0, 1.0) - 1.0); };
  }
  if (pick == 1) {
    name = "slow sine";
    const double cycles = draw.uniform(0.6, 2.5);
    const double phase_rad = draw.uniform(0.0, 2.0 * std::numbers::pi);
    return [=](double t_s) {
      return std::sin(2.0 * std::numbers::pi * cycles * t_s / length_s + phase_rad);
    };
  }
  name = "exponential";
  const double tau_s = length_s * draw.uniform(0.2, 0.6);
  return [=](double t_s) { return sign * (2.0 * std::exp(-std::max(0.0, t_s) / tau_s) - 1.0); };
}

void put_gain(Plant& plant, bool on_drive, std::function<double(double)> gain_at) {
  (on_drive ? plant.drive : plant.sensitivity)
      .push_back([gain_at = std::move(gain_at)](const Scene& scene, Series& values) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] *= gain_at(scene.grid.time_s(i));
      });
}

Effect varying_gain(double length_s, bool on_drive, Draw& draw) {
  Effect out;
  std::string shape_name;
  const auto shape = slow_shape(length_s, draw, shape_name);
  out.variant = shape_name + (on_drive ? ", drive" : ", force");
  out.plant = [=](double size, Plant& plant) {
    put_gain(plant, on_drive, [=](double t_s) { return 1.0 + 0.9 * size * shape(t_s); });
  };
  out.parameters = [](double size) -> std::vector<Parameter> {
    return {{"swing", 0.9 * size, "-"}};
  };
  return out;
}

Effect regime_change(double length_s, bool on_drive, Draw& draw) {
  Effect out;
  const double at_s = length_s * draw.uniform(0.25, 0.75);
  const double over_s = draw.chance(0.5) ? 0.0 : draw.uniform(0.02, 0.3);
  const double most = draw.chance(0.5) ? 1.5 : -0.8;
  out.variant = on_drive ? "gain of the drive" : "gain of the force";
  out.plant = [=](double size, Plant& plant) {
    put_gain(plant, on_drive, [=](double t_s) {
      const double part =
          over_s > 0.0 ? std::clamp((t_s - at_s) / over_s, 0.0, 1.0) : (t_s >= at_s ? 1.0 : 0.0);
      return 1.0 + most * size * part;
    });
  };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{"time", at_s, "s"}, {"gain_after", 1.0 + most * size, "-"}, {"over", over_s, "s"}};
  };
  return out;
}

}  // namespace

Effect draw_range_effect(Kind kind, const Reference& reference, Draw& draw) {
  Effect out;
  out.kind = kind;
  const bool hard = draw.chance(0.6);
  const bool at_input =
      kind == Kind::kInputSaturation || (kind == Kind::kDeadZone && draw.chance(0.5));
  const double rms = at_input ? reference.acceleration_rms_m_s2 : reference.force_rms_n;
  const std::string unit = at_input ? "m/s^2" : "N";
  const bool dead = kind == Kind::kDeadZone;
  const auto level = [=](double size) {
    return rms * (dead ? between(size, 0.01, 2.5) : between(size, 4.0, 0.15));
  };
  out.variant = std::string(at_input ? "drive" : "load cell") + (dead   ? ", threshold"
                                                                 : hard ? ", clips"
                                                                        : ", soft limit");
  if (at_input) out.channels = {"a_y"};
  // Half of the clipping load cells clip their own noise as well.
  out.reads_noise = kind == Kind::kOutputSaturation && hard && draw.chance(0.5);
  if (out.reads_noise) out.variant += " with its noise";
  out.plant = [=](double size, Plant& plant) {
    (at_input ? plant.drive : plant.reading)
        .push_back(memoryless(dead ? threshold(level(size)) : limit(hard, level(size))));
  };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{dead ? "half_width" : "level", level(size), unit}};
  };
  return out;
}

Effect draw_gain_effect(Kind kind, const Scene& scene, Draw& draw) {
  const double length_s = scene.grid.time_s(scene.grid.at(scene.grid.recorded));
  const bool on_drive = draw.chance(0.3);
  Effect out = kind == Kind::kRegimeChange ? regime_change(length_s, on_drive, draw)
                                           : varying_gain(length_s, on_drive, draw);
  out.kind = kind;
  return out;
}

Effect draw_clock_effect(Kind kind, Draw& draw) {
  Effect out;
  out.kind = kind;
  out.channels = {"a_y"};
  if (kind == Kind::kDelay) {
    out.variant = "load cell late";
    out.any_size = true;
    // Most load-cell amplifiers and filters: 20 to 80 ms; the rest is what an order-4 fit can't
    // hide.
    const auto delay_s = [](double size) { return between(size, 0.020, 0.200); };
    out.plant = [=](double size, Plant& plant) { plant.force_delay_s = delay_s(size); };
    out.parameters = [=](double size) -> std::vector<Parameter> {
      return {{"delay", delay_s(size), "s"}};
    };
    return out;
  }
  out.variant = "clock of the load cell";
  const auto error = [sign = draw.sign()](double size) {
    return sign * between(size, 30e-6, 1500e-6);
  };
  out.plant = [=](double size, Plant& plant) { plant.force_clock_error = error(size); };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{"error", 1e6 * error(size), "ppm"}};
  };
  return out;
}

}  // namespace stillhand::planted
