// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "tests/planted/body.hpp"
#include "tests/planted/scene.hpp"

namespace stillhand::planted {

/// Changes a signal over the whole grid, in place.
using Stage = std::function<void(const Scene& scene, Series& values)>;

/// Stages from the recorded acceleration to the recorded force, in their physical order.
struct Plant {
  Body body;
  bool body_altered = false;         ///< false: the force of the original body is used again
  std::vector<Stage> drive{};        ///< recorded command -> acceleration that acts
  std::vector<Stage> sensitivity{};  ///< gain of the force
  std::vector<Stage> added{};        ///< additional forces of other causes
  std::vector<Stage> reading{};      ///< limits of the load cell, on the recording's samples
  double force_delay_s = 0.0;
  double force_clock_error = 0.0;  ///< e: the sample stamped t is taken at t (1 + e)
};

/// Force of the body on the grid, before any output stage.
Motion body_force(const Scene& scene, const Plant& plant);
/// From that force to the recorded samples: gain, added forces, clock and delay of the force, noise
/// before the reading (one value for each sample, or none), reading.
Series recorded_force(const Scene& scene, const Plant& plant, Series body_force_n,
                      const Series& early_noise_n = {});

}  // namespace stillhand::planted
