// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/rig/parts/body_config.hpp"
#include "services/core/rig/parts/motor.hpp"
#include "services/core/rig/parts/platform.hpp"
#include "services/core/rig/parts/sensors.hpp"

namespace stillhand::rig {

/// The whole simulated rig.
struct RigConfig {
  std::int64_t seed = 1;
  double max_operator_force_n = 60.0;
  std::int64_t max_operator_age_ticks = 100;
  PlatformConfig platform;
  BodyConfig body;
  StickConfig stick;
  MotorConfig motor;
  SensorConfig sensors;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("seed", self.seed, Range{0.0, 4294967295.0}, "[-] seed of the sensor noise");
    visit("max_operator_force_n", self.max_operator_force_n, Range{0.0, 60.0},
          "[N] bound of the volitional force at the hand");
    visit("max_operator_age_ticks", self.max_operator_age_ticks, Range{1.0, 10000.0},
          "[ticks] oldest volitional force that still acts; older ones fade to zero");
    visit.group("platform", self.platform);
    visit.group("body", self.body);
    visit.group("stick", self.stick);
    visit.group("motor", self.motor);
    visit.group("sensors", self.sensors);
  }
};

}  // namespace stillhand::rig
