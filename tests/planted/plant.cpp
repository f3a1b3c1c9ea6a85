// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/plant.hpp"

namespace stillhand::planted {
namespace {

Series sampled(const Grid& grid, const Plant& plant, const Series& force_n) {
  Series out(grid.recorded);
  const bool one_clock = plant.force_delay_s == 0.0 && plant.force_clock_error == 0.0;
  for (std::size_t n = 0; n < out.size(); ++n) {
    if (one_clock) {
      out[n] = force_n[grid.at(n)];
      continue;
    }
    const auto steps = static_cast<double>(n * grid.per_sample);
    out[n] = interpolate(force_n, static_cast<double>(grid.before) +
                                      steps * (1.0 + plant.force_clock_error) -
                                      plant.force_delay_s * grid.rate_hz);
  }
  return out;
}

}  // namespace

Motion body_force(const Scene& scene, const Plant& plant) {
  Series acting_m_s2 = scene.of("a_y");
  for (const Stage& stage : plant.drive) stage(scene, acting_m_s2);
  return simulate(plant.body, acting_m_s2, 1.0 / scene.grid.rate_hz);
}

Series recorded_force(const Scene& scene, const Plant& plant, Series body_force_n,
                      const Series& early_noise_n) {
  for (const Stage& stage : plant.sensitivity) stage(scene, body_force_n);
  for (const Stage& stage : plant.added) stage(scene, body_force_n);
  Series out = sampled(scene.grid, plant, body_force_n);
  for (std::size_t n = 0; n < early_noise_n.size(); ++n) out[n] += early_noise_n[n];
  for (const Stage& stage : plant.reading) stage(scene, out);
  return out;
}

}  // namespace stillhand::planted
