// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/cancellation/sampling.hpp"
#include "services/core/contract/config_field.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::cancellation {

struct Config {
  signal::ForceLimits limits;
  SamplingConfig sampling;
  double gain = 1.0;
  double max_model_gain_n_s2_m = 60.0;
  double max_path_force_n = 25.0;
  double max_acceleration_m_s2 = 16.0;
  std::int64_t fade_ticks = 250;
  std::int64_t max_hold_ticks = 50;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("limits", self.limits);
    visit.group("sampling", self.sampling);
    visit("gain", self.gain, Range{0.0, 1.2}, "[-] share of the predicted force that is cancelled");
    visit("max_model_gain_n_s2_m", self.max_model_gain_n_s2_m, Range{1.0, 200.0},
          "[N s^2/m] largest |H| of a model, any frequency; paper IV-A: 3.2 at 0 Hz");
    visit("max_path_force_n", self.max_path_force_n, Range{0.0, 60.0},
          "[N] most that a model may ask for from the stick at its full scale, or from a tone");
    visit("max_acceleration_m_s2", self.max_acceleration_m_s2, Range{1.0, 500.0},
          "[m/s^2] a larger magnitude is a fault: above a platform's limit, below a sensor's end");
    visit("fade_ticks", self.fade_ticks, Range{50.0, 5000.0},
          "[ticks] fade from zero or from the model before, after the new one has settled");
    visit(
        "max_hold_ticks", self.max_hold_ticks, Range{1.0, 200.0},
        "[ticks] longest run of missing samples bridged by holding the last; then start from rest");
  }
};

/// What these settings let a model ask for.
inline ModelBounds bounds(const Config& config) noexcept {
  return {config.max_model_gain_n_s2_m, config.max_path_force_n, config.sampling.model_ticks};
}

}  // namespace stillhand::cancellation
