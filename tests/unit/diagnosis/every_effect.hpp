// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/examples.hpp"
#include "tests/unit/diagnosis/effects_next_to_the_body.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

/// One effect of every kind and form, or a kind's own examples, ready to run next to
/// made::two_pole_body().
namespace stillhand::diagnosis::made {

/// The channels that they read: u (input), a_x, theta, omega, temp; and the output y.
inline Measurement every_channel(std::size_t count, std::uint64_t seed) {
  return measurement_of({{"u", "m/s^2", ride(count, seed)},
                         {"a_x", "m/s^2", ride(count, seed + 1)},
                         {"theta", "rad", ride(count, seed + 2, 0.1, 1.0)},
                         {"omega", "rad/s", ride(count, seed + 3, 0.2, 2.0)},
                         {"temp", "degC", ride(count, seed + 4, 0.1, 0.5)},
                         {"y", "N", ride(count, seed + 5)}});
}

inline std::vector<Effect> effects_before_the_body() {
  return {
      {"delay", "of the input", {}, {{"delay", "s", 0.0371, -0.1, 0.5}}, {}},
      effect_of("clock_drift", "of the output", {},
                {{"drift", "us/s", 900.0, -2e4, 2e4}, constant("reference_time", "s", 3.0)}),
      {"input_saturation", "hard", {"u"}, {{"limit", "m/s^2", 0.9, 0.02, 9.0}}, {}},
      {"input_saturation", "soft", {"u"}, {{"limit", "m/s^2", 1.3, 0.02, 9.0}}, {}},
      {"dead_zone", "at the input", {"u"}, {{"half_width", "m/s^2", 0.3, 0.0, 3.0}}, {}},
      {"asymmetry", "slopes at the input", {"u"}, {{"slope_change", "-", 0.3, -0.9, 0.9}}, {}},
      effect_of("asymmetry", "square at the input", {"u"},
                {{"square_share", "-", 0.4, -2.0, 2.0}, constant("largest_input", "m/s^2", 3.0)}),
      effect_of("free_form", "curve of the input", {"u"},
                {constant("knot_1", "m/s^2", -1.0),
                 constant("knot_2", "m/s^2", 0.1),
                 constant("knot_3", "m/s^2", 1.2),
                 constant("height_1", "m/s^2", -1.0),
                 constant("height_2", "m/s^2", 0.1),
                 {"height_3", "m/s^2", 0.7, -9.0, 9.0}}),
  };
}

// Two coefficients of a loop around the output, eight of one inside a body of order 2.
inline std::vector<Effect> effects_inside_the_body() {
  const std::vector<double> inside{0.02, -0.01, 0.005, 0.4, 0.1, 0.0, -0.01, 0.002};
  return {
      effect_of("nonlinear_stiffness", "bent of the output", {},
                {{"threshold", "N", 0.6, 0.01, 30.0}}, {-0.02, 0.01}),
      {"nonlinear_stiffness", "levelled inside the body", {}, {}, inside},
      effect_of("free_form", "curve inside the body", {},
                {constant("knot_1", "-", -1.5),
                 constant("knot_2", "-", -0.4),
                 constant("knot_3", "-", 0.3),
                 constant("knot_4", "-", 1.4),
                 constant("height_1", "-", -1.0),
                 {"height_2", "-", -0.2, -9.0, 9.0},
                 constant("height_3", "-", 0.5),
                 constant("height_4", "-", 0.8)},
                inside),
      effect_of("nonlinear_stiffness", "cubic of the output", {}, {constant("threshold", "N", 1.0)},
                {-1e-3, 0.0}),
      {"asymmetry", "slopes of the output", {}, {constant("threshold", "N", 1.0)}, {0.01, -0.005}},
      {"asymmetry", "square of the output", {}, {constant("threshold", "N", 1.0)}, {1e-3, 0.0}},
      effect_of("hysteresis", "elastic-plastic of the output", {},
                {{"threshold", "N", 0.5, 0.01, 25.0}}, {-0.03, 0.02}),
      {"hysteresis", "smooth inside the body", {}, {}, inside},
      {"dead_zone", "play of the output", {}, {{"threshold", "N", 0.4, 0.01, 20.0}}, {0.03, -0.01}},
      {"output_saturation", "stop above", {}, {constant("limit", "N", 0.4)}, {}},
      {"output_saturation", "stop below", {}, {constant("limit", "N", -0.3)}, {}},
  };
}

inline std::vector<Effect> effects_on_the_gain() {
  const auto change = [](const char* name, double value) {
    return Parameter{name, "-", value, -3.0, 3.0};
  };
  return {
      effect_of(
          "free_form", "gain over a channel", {"temp"},
          {constant("knot_1", "degC", -1.0), constant("knot_2", "degC", 0.1),
           constant("knot_3", "degC", 1.2), change("change_1", -0.2), change("change_2", 0.4)}),
      effect_of("free_form", "gain over the size of an input", {"u"},
                {constant("memory", "s", 2.0), constant("knot_1", "m/s^2", 0.7),
                 constant("knot_2", "m/s^2", 0.9), constant("knot_3", "m/s^2", 1.4),
                 change("change_1", -0.3), change("change_2", 0.2)}),
      {"time_varying_gain", "linear", {}, {{"change", "-", 0.2, -3.0, 3.0}}, {}},
      effect_of("time_varying_gain", "slow cosines", {},
                {{"half_cosine_1", "-", 0.1, -3.0, 3.0}, {"half_cosine_2", "-", -0.2, -3.0, 3.0}}),
      effect_of("time_varying_gain", "sinusoidal", {},
                {{"cycles_per_record", "-", 2.0, 0.5, 12.0},
                 {"sine", "-", 0.3, -3.0, 3.0},
                 {"cosine", "-", -0.1, -3.0, 3.0}}),
      effect_of("regime_change", "step of the gain", {},
                {{"time", "s", 4.0, 0.0, 60.0, false}, {"change", "-", 0.25, -5.0, 5.0}}),
      effect_of("bilinear", "gain of the body", {"temp"},
                {{"sensitivity", "1/(degC)", 0.3, -10.0, 10.0}, constant("centre", "degC", 0.1)}),
  };
}

inline std::vector<Effect> effects_behind_the_body() {
  return {
      {"nonlinear_stiffness", "at the output", {}, {{"cubic", "1/N^2", 0.05, -1.0, 1.0}}, {}},
      {"asymmetry", "slopes at the output", {}, {{"slope_change", "-", -0.3, -0.9, 0.9}}, {}},
      {"asymmetry", "size at the output", {}, {}, {}},
      {"dead_zone", "at the output", {}, {{"half_width", "N", 0.1, 0.0, 3.0}}, {}},
      {"output_saturation", "hard", {}, {{"limit", "N", 0.3, 0.01, 9.0}}, {}},
      {"output_saturation", "soft", {}, {{"limit", "N", 0.5, 0.01, 9.0}}, {}},
      {"output_saturation", "clip above", {}, {constant("limit", "N", 0.4)}, {}},
      {"output_saturation", "clip below", {}, {constant("limit", "N", -0.3)}, {}},
      effect_of("output_saturation", "hard, two limits", {},
                {{"upper_limit", "N", 0.4, 0.01, 9.0}, {"lower_limit", "N", -0.2, -9.0, -0.01}}),
  };
}

inline Effect one_burst() {
  return {"transients",
          "isolated bursts",
          {},
          {{"begin_1", "s", 3.0, -0.15, 60.0, false}, {"end_1", "s", 3.5, -0.15, 60.0, false}},
          {}};
}

inline std::vector<Effect> every_effect() {
  std::vector<Effect> all;
  for (const auto& part :
       {effects_before_the_body(), effects_inside_the_body(), effects_on_the_gain(),
        effects_next_to_the_body(), effects_behind_the_body()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  all.push_back(one_burst());
  const Model model = model_of(two_pole_body());
  const Signals signals(every_channel(600, 11), {"u"}, "y");
  for (const EffectKind* kind : effect_kinds()) {
    const auto* const maker = dynamic_cast<const MakesExamples*>(kind);
    if (maker == nullptr) continue;
    // Of measured channels: one that is made of others looks ahead.
    for (const Effect& own : maker->examples(model, signals)) {
      const bool measured = std::ranges::none_of(
          own.channels, [&](const auto& channel) { return signals.at(channel).derived; });
      if (measured) all.push_back(own);
    }
  }
  return all;
}

}  // namespace stillhand::diagnosis::made
