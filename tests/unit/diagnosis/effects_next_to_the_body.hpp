// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::made {

/// One effect of every kind and form that adds terms, for a body of order 2: every_effect.hpp.
inline std::vector<Effect> effects_next_to_the_body() {
  const Parameter centre = constant("centre", "rad", 0.05);
  const auto knots = [](const char* unit) {
    return std::vector<Parameter>{constant("knot_1", unit, -1.0), constant("knot_2", unit, 0.1),
                                  constant("knot_3", unit, 1.2)};
  };
  return {
      {"free_form", "force over a channel", {"theta"}, knots("rad"), {0.3, -0.2}},
      {"free_form", "factor over a channel", {"omega", "theta"}, knots("rad"), {0.3, 0.1, -0.2}},
      effect_of("resonance", "beside the body", {},
                {{"frequency", "Hz", 9.0, 0.15, 40.0}, {"damping_ratio", "-", 0.1, 0.003, 0.95}},
                {0.05, 0.02}),
      {"coupled_input", "static", {"a_x"}, {}, {0.2}},
      {"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.15, 0.005, 2.0}}, {0.5}},
      {"coupled_input", "through the body", {"a_x"}, {}, {0.1, -0.05, 0.02}},
      {"coupled_input", "static with rate", {"theta", "omega"}, {}, {0.2, 0.1}},
      {"coulomb_friction", "sign, beside the body", {"omega"}, {}, {-0.4}},
      effect_of("coulomb_friction", "smooth sign, beside the body", {"omega"},
                {{"transition_rate", "rad/s", 0.2, 1e-3, 0.6}}, {-0.4}),
      {"coulomb_friction", "sign, through the body", {"omega"}, {}, {-0.1, 0.05, 0.0}},
      {"nonlinear_stiffness", "cubic, beside the body", {"theta"}, {centre}, {0.1, 0.3}},
      {"asymmetry", "square, beside the body", {"theta"}, {centre}, {0.3}},
      {"asymmetry", "square, through the body", {"theta"}, {centre}, {0.1, 0.0, 0.05}},
      effect_of("hysteresis", "elastic-plastic, beside the body", {"theta"},
                {{"threshold", "rad", 0.4, 1e-3, 5.0}}, {0.3, -0.1}),
      effect_of("hysteresis", "smooth, beside the body", {"theta"},
                {{"threshold", "rad", 0.4, 1e-3, 5.0}}, {0.3, -0.1}),
      effect_of("dead_zone", "beside the body", {"theta"},
                {{"half_width", "rad", 0.3, 0.0, 3.0}, centre}, {0.5}),
      effect_of("position_ripple", "one harmonic", {"theta"},
                {{"spatial_frequency", "1/rad", 2.5, 2.0, 3.0}}, {0.1, 0.2}),
      effect_of("position_ripple", "two harmonics", {"theta"},
                {{"spatial_frequency", "1/rad", 2.5, 2.0, 3.0}}, {0.1, 0.2, -0.1, 0.05}),
      {"tone", "beside the body", {}, {{"frequency", "Hz", 9.3, 9.2, 9.4}}, {0.1, 0.2}},
      {"drift", "linear", {}, {}, {0.3}},
      {"drift", "exponential", {}, {{"time_constant", "s", 5.0, 0.1, 60.0}}, {0.3}},
      {"drift", "slow cosines", {}, {}, {0.3, -0.2, 0.1}},
      effect_of("bilinear", "beside the body", {"a_x", "theta"},
                {constant("centre_1", "m/s^2", 0.1), constant("centre_2", "rad", -0.1)}, {0.3}),
      effect_of("bilinear", "through the body", {"a_x", "theta"},
                {constant("centre_1", "m/s^2", 0.1), constant("centre_2", "rad", -0.1)},
                {0.1, 0.2, 0.3}),
  };
}

}  // namespace stillhand::diagnosis::made
