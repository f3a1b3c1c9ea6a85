// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/contract/config_field.hpp"
#include "services/core/vehicle/driven_motion.hpp"

namespace stillhand::vehicle {

/// vehicle.yaml: what the process reads besides the platform's limits, which are motion.yaml's.
struct VehicleSettings {
  VehicleConfig vehicle;
  signal::OscillationLimits oscillation;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("vehicle", self.vehicle);
    visit.group("oscillation", self.oscillation);
  }
};

/// The word for "as in vehicle.yaml" where a preset may be named.
inline constexpr const char* kOwnVehicle = "settings";

/// Settings of a drive: dynamics and delay of the preset, or those of the settings; gain, bounds,
/// washout and detector are always the settings'.
/// @throws stillhand::ConfigError for an unknown preset.
inline DrivenConfig driven_config(const motion::PlatformLimits& limits,
                                  const VehicleSettings& settings, const std::string& name) {
  DrivenConfig config{limits, settings.vehicle, settings.oscillation};
  if (name == kOwnVehicle) return config;
  const VehicleConfig named = preset(name);
  config.vehicle.speed_follows = named.speed_follows;
  config.vehicle.order = named.order;
  config.vehicle.delay_s = named.delay_s;
  config.vehicle.lag_s = named.lag_s;
  config.vehicle.natural_hz = named.natural_hz;
  config.vehicle.damping_ratio = named.damping_ratio;
  return config;
}

}  // namespace stillhand::vehicle
