// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/planted/body.hpp"
#include "tests/planted/kind.hpp"
#include "tests/planted/plant.hpp"
#include "tests/planted/scene.hpp"

namespace stillhand::planted {

/// One number of a planted effect, as the truth file gives it.
struct Parameter {
  std::string name;
  double value = 0.0;
  std::string unit;
};

/// Sizes of the untouched recording, to scale what is planted.
struct Reference {
  double force_rms_n = 0.0;
  double acceleration_rms_m_s2 = 0.0;
  double seat_rms_m = 0.0;
  double shoulder_rms_m = 0.0;
  double grip_rms_m = 0.0;
};

/// An effect of which everything is drawn but its size.
struct Effect {
  Kind kind{};
  std::string variant;  ///< where and how, for example "grip spring, hardening"
  std::vector<std::string>
      channels;                   ///< the ones it depends on, without a_y unless it is the point
  std::vector<std::string> also;  ///< channels that carry nearly the same: not wrong to name
  bool any_size = false;  ///< the sensible range lies beyond the strengths asked for: size is drawn
  bool reads_noise = false;  ///< the noise arises before the reading stages, which act on it too
  /// Changes the plant; size in 0 (barely there) .. 1 (largest sensible), stronger as it grows.
  std::function<void(double size, Plant& plant)> plant;
  std::function<std::vector<Parameter>(double size)> parameters;
};

/// Draws place, sign, shape and channel of an effect.
Effect draw_effect(Kind kind, const Scene& scene, const Body& body, const Reference& reference,
                   Draw& draw);

// By where they act; draw_effect chooses.
Effect draw_spring_effect(Kind kind, const Reference& reference, Draw& draw);
Effect draw_resonance(const Scene& scene, const Body& body, Draw& draw);
Effect draw_range_effect(Kind kind, const Reference& reference, Draw& draw);
Effect draw_gain_effect(Kind kind, const Scene& scene, Draw& draw);
Effect draw_clock_effect(Kind kind, Draw& draw);
Effect draw_channel_effect(Kind kind, const Scene& scene, const Reference& reference, Draw& draw);
Effect draw_time_effect(Kind kind, const Scene& scene, const Reference& reference, Draw& draw);

}  // namespace stillhand::planted
