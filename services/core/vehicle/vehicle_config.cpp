// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/vehicle_config.hpp"

#include <algorithm>

#include "services/core/contract/config_error.hpp"

namespace stillhand::vehicle {

const std::vector<std::string>& preset_names() {
  static const std::vector<std::string> names{"first_order", "second_order", "excavator",
                                              "wheelchair", "aircraft_roll"};
  return names;
}

// Where each number is from: README, "Presets".
VehicleConfig preset(std::string_view name) {
  VehicleConfig config;
  if (name == "second_order") {
    config.order = 2;
  } else if (name == "excavator") {
    config.speed_follows = true;
    config.order = 2;
    config.natural_hz = 1.5;
    config.damping_ratio = 0.3;
    config.delay_s = 0.15;
  } else if (name == "wheelchair") {
    config.speed_follows = true;
    config.lag_s = 0.5;
    config.delay_s = 0.06;
  } else if (name == "aircraft_roll") {
    config.speed_follows = true;
    config.lag_s = 0.4;
    config.delay_s = 0.1;
  } else if (name != "first_order") {
    std::string known;
    for (const std::string& each : preset_names()) known += (known.empty() ? "" : ", ") + each;
    throw ConfigError("vehicle", "\"" + std::string(name) + "\"", "one of " + known);
  }
  return config;
}

}  // namespace stillhand::vehicle
