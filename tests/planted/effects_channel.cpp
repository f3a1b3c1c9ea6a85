// SPDX-License-Identifier: Apache-2.0
// Forces that other channels add.
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "tests/planted/effect.hpp"

namespace stillhand::planted {
namespace {

/// What an effect makes of a scene's channels.
using Wave = std::function<Series(const Scene&)>;

/// The wave of the scene on which the effect was drawn is kept: every trial size of the search, and
/// every copy of the effect, adds it.  On another scene it is made again.
Wave kept(const Scene& drawn_on, Wave wave) {
  return [identity = drawn_on.identity, shared = std::make_shared<const Series>(wave(drawn_on)),
          wave](const Scene& scene) { return scene.identity == identity ? *shared : wave(scene); };
}

/// Adds `wave`, scaled so that size 1 is as large as the force itself; its mean is left out, since
/// a constant is part of every baseline.
Effect added(Kind kind, const Scene& scene, const Wave& wave_of, double force_rms_n, double sign,
             const std::string& name, const std::string& unit, std::vector<Parameter> fixed) {
  Effect out;
  out.kind = kind;
  const Wave wave = kept(scene, wave_of);
  const Series once = wave(scene);
  const double mean = mean_of(once);
  const double largest = sign * force_rms_n / spread_of(once);
  out.plant = [wave, mean, largest](double size, Plant& plant) {
    plant.added.push_back([wave, mean, gain = largest * size](const Scene& where, Series& f) {
      const Series values = wave(where);
      for (std::size_t i = 0; i < f.size(); ++i) f[i] += gain * (values[i] - mean);
    });
  };
  out.parameters = [=](double size) {
    std::vector<Parameter> all{{name, largest * size, unit}};
    all.insert(all.end(), fixed.begin(), fixed.end());
    return all;
  };
  return out;
}

std::string unit_of(const Scene& scene, const std::string& name) {
  for (const Signal& signal : scene.signals) {
    if (signal.name == name) return signal.unit;
  }
  return "-";
}

std::vector<std::string> look_alikes(const std::string& name) {
  if (name == "theta") return {"x_p", "omega"};
  if (name == "omega") return {"theta", "x_p"};
  return {};
}

Effect coupled_input(const Scene& scene, const Reference& reference, Draw& draw) {
  static constexpr std::array kNames{"a_x", "a_z", "roll", "theta", "omega", "temp"};
  static constexpr std::array kSlowest_s{0.15, 0.1, 0.5, 0.5, 0.3, 15.0};
  const std::size_t which = draw.index(kNames.size());
  const std::string name = kNames[which];
  Wave wave = [name](const Scene& where) { return where.of(name); };
  std::vector<Parameter> fixed;
  const double pick = draw.unit();
  const bool springy = pick > 0.75 && which < 2;  // an acceleration that reaches the hand by a mode
  const bool lagged = pick > 0.5 && !springy;
  if (lagged) {
    const double tau_s = draw.uniform(0.3, 1.0) * kSlowest_s[which];
    wave = [name, tau_s](const Scene& where) {
      Series values = where.of(name);
      lag(values, where.grid.rate_hz, tau_s);
      return values;
    };
    fixed.push_back({"lag", tau_s, "s"});
  } else if (springy) {
    const double natural_hz = draw.uniform(2.0, 6.0);
    const double damping = draw.uniform(0.2, 0.5);
    wave = [name, natural_hz, damping](const Scene& where) {
      Series values = where.of(name);
      resonate(values, where.grid.rate_hz, natural_hz, damping);
      return values;
    };
    fixed.push_back({"frequency", natural_hz, "Hz"});
    fixed.push_back({"damping", damping, "-"});
  }
  Effect out = added(Kind::kCoupledInput, scene, wave, reference.force_rms_n, draw.sign(), "gain",
                     "N/(" + unit_of(scene, name) + ")", fixed);
  out.variant = name + (lagged ? ", lagged" : springy ? ", through a mode" : ", static");
  out.channels = {name};
  out.also = look_alikes(name);
  return out;
}

Effect friction(const Scene& scene, const Reference& reference, Draw& draw) {
  const bool sharp = draw.chance(0.5);
  const double scale_rad_s = sharp ? 0.0 : spread_of(scene.of("omega")) * draw.uniform(0.02, 0.15);
  const Wave wave = [sharp, scale_rad_s](const Scene& where) {
    Series values = where.of("omega");
    for (double& omega : values) {
      omega = sharp ? (omega > 0.0   ? 1.0
                       : omega < 0.0 ? -1.0
                                     : 0.0)
                    : std::tanh(omega / scale_rad_s);
    }
    return values;
  };
  Effect out = added(Kind::kCoulombFriction, scene, wave, reference.force_rms_n, -1.0, "force", "N",
                     {{"width", scale_rad_s, "rad/s"}});
  out.variant = sharp ? "sign of the stick's rate" : "steep tanh of the stick's rate";
  out.channels = {"omega"};
  out.also = {"theta", "x_p"};
  return out;
}

Effect ripple(const Scene& scene, const Reference& reference, Draw& draw) {
  const double cycles = std::floor(draw.log_uniform(20.0, 90.0));
  const double phase_rad = draw.uniform(0.0, 2.0 * std::numbers::pi);
  const double second = draw.chance(0.3) ? draw.uniform(0.2, 0.5) : 0.0;
  const Wave wave = [=](const Scene& where) {
    Series values = where.of("theta");
    for (double& theta : values) {
      const double angle_rad = cycles * theta + phase_rad;
      theta = std::sin(angle_rad) + second * std::sin(2.0 * angle_rad);
    }
    return values;
  };
  Effect out =
      added(Kind::kPositionRipple, scene, wave, reference.force_rms_n, 1.0, "amplitude", "N",
            {{"period", 2.0 * std::numbers::pi / cycles, "rad"}, {"second_harmonic", second, "-"}});
  out.variant = second > 0.0 ? "cogging, two harmonics" : "cogging";
  out.channels = {"theta"};
  out.also = {"x_p"};
  return out;
}

Effect bilinear(const Scene& scene, const Reference& reference, Draw& draw) {
  static constexpr std::array<std::array<const char*, 2>, 6> kPairs{{{"grip", "a_y"},
                                                                     {"roll", "a_x"},
                                                                     {"theta", "a_y"},
                                                                     {"roll", "a_y"},
                                                                     {"grip", "a_z"},
                                                                     {"omega", "a_x"}}};
  const auto& pair = kPairs[draw.index(kPairs.size())];
  // Its mean times the other channel would be a coupled input.
  const double mean = mean_of(scene.of(pair[0]));
  std::vector<Parameter> fixed;
  const bool lagged = draw.chance(0.3);
  const double tau_s = lagged ? draw.uniform(0.02, 0.1) : 0.0;
  if (lagged) fixed.push_back({"lag", tau_s, "s"});
  const Wave wave = [first = pair[0], other = pair[1], mean, tau_s](const Scene& where) {
    Series values = where.of(first);
    const Series& second = where.of(other);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = (values[i] - mean) * second[i];
    if (tau_s > 0.0) lag(values, where.grid.rate_hz, tau_s);
    return values;
  };
  Effect out = added(Kind::kBilinear, scene, wave, reference.force_rms_n, draw.sign(), "gain",
                     "N/(" + unit_of(scene, pair[0]) + " " + unit_of(scene, pair[1]) + ")", fixed);
  out.variant = std::string(pair[0]) + " times " + pair[1] + (lagged ? ", lagged" : "");
  out.channels = {pair[0], pair[1]};
  out.also = look_alikes(pair[0]);
  return out;
}

/// Bouc-Wen variable of an angle, yield angle 1.
Series yielding(const Series& angle, double yield_rad, double sharpness) {
  Series out(angle.size());
  double h = 0.0;
  for (std::size_t i = 0; i < angle.size(); ++i) {
    const double step = i == 0 ? 0.0 : (angle[i] - angle[i - 1]) / yield_rad;
    h += step * (1.0 - (step * h > 0.0 ? std::pow(std::abs(h), sharpness) : 0.0));
    out[i] = h;
  }
  return out;
}

/// Between stick and its centring spring: play, or a rubber that yields.
Effect angle_hysteresis(const Scene& scene, const Reference& reference, Draw& draw) {
  const bool with_play = draw.chance(0.5);
  const double width_rad = spread_of(scene.of("theta")) * draw.uniform(0.3, 0.9);
  const double sharpness = with_play ? 0.0 : (draw.chance(0.5) ? 1.0 : 2.0);
  const Wave wave = [=](const Scene& where) {
    Series values = where.of("theta");
    if (!with_play) return yielding(values, width_rad, sharpness);
    play(values, width_rad);
    return values;
  };
  Effect out = added(Kind::kHysteresis, scene, wave, reference.force_rms_n, -1.0,
                     with_play ? "stiffness" : "force", with_play ? "N/rad" : "N",
                     {{with_play ? "half_width" : "yield", width_rad, "rad"}});
  out.variant = with_play ? "stick's centring spring with play" : "stick's rubber, Bouc-Wen";
  out.channels = {"theta"};
  out.also = {"x_p", "omega"};
  return out;
}

/// The arm stiffens with the grip: the force goes with the product of both.
Effect gripped(const Scene& scene, const std::string& name, Draw& draw) {
  const double mean = mean_of(scene.of(name));
  const double spread = spread_of(scene.of(name));
  const Wave shape = kept(scene, [=](const Scene& where) {
    Series values = where.of(name);
    for (double& value : values) value = (value - mean) / spread;
    return values;
  });
  const double most = 0.5 * draw.sign();
  Effect out;
  out.kind = Kind::kBilinear;
  out.variant = "gain follows " + name;
  out.channels = {name, "a_y"};
  out.also = look_alikes(name);
  out.plant = [=](double size, Plant& plant) {
    plant.sensitivity.push_back([shape, most, size](const Scene& where, Series& f) {
      const Series values = shape(where);
      for (std::size_t i = 0; i < f.size(); ++i) f[i] *= 1.0 + most * size * values[i];
    });
  };
  out.parameters = [=, unit = unit_of(scene, name)](double size) -> std::vector<Parameter> {
    return {{"gain", most * size / spread, "1/" + unit}};
  };
  return out;
}

}  // namespace

Effect draw_channel_effect(Kind kind, const Scene& scene, const Reference& reference, Draw& draw) {
  if (kind == Kind::kCoupledInput) return coupled_input(scene, reference, draw);
  if (kind == Kind::kCoulombFriction) return friction(scene, reference, draw);
  if (kind == Kind::kPositionRipple) return ripple(scene, reference, draw);
  if (kind == Kind::kHysteresis) return angle_hysteresis(scene, reference, draw);
  if (draw.chance(0.25)) return gripped(scene, draw.chance(0.7) ? "grip" : "theta", draw);
  return bilinear(scene, reference, draw);
}

}  // namespace stillhand::planted
