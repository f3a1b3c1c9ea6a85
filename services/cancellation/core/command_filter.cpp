// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/command_filter.hpp"

#include <cmath>
#include <string>

#include "services/contract/config_error.hpp"
#include "services/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

signal::SecondOrderLag lag(const CommandFilterConfig& config) {
  const auto positive = [](const char* key, double value) {
    if (!(value > 0.0 && std::isfinite(value))) {
      throw ConfigError(std::string("command_filter.") + key, std::to_string(value),
                        "a value above 0");
    }
  };
  positive("mass_kg", config.mass_kg);
  positive("damping_n_s_m", config.damping_n_s_m);
  positive("stiffness_n_m", config.stiffness_n_m);
  positive("lever_m", config.lever_m);
  const double critical_n_s_m = 2.0 * std::sqrt(config.stiffness_n_m * config.mass_kg);
  if (!(config.damping_n_s_m < critical_n_s_m)) {
    throw ConfigError("command_filter.damping_n_s_m", std::to_string(config.damping_n_s_m),
                      "less than critical, " + std::to_string(critical_n_s_m));
  }
  return {std::sqrt(config.stiffness_n_m / config.mass_kg), config.damping_n_s_m / critical_n_s_m,
          kControlPeriod_s};
}

}  // namespace

CommandFilter::CommandFilter(const CommandFilterConfig& config)
    : compliance_m_n_(1.0 / config.stiffness_n_m), lever_m_(config.lever_m), lag_(lag(config)) {}

}  // namespace stillhand::cancellation
