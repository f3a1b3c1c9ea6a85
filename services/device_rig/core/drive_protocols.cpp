// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/core/drive_protocols.hpp"

#include "services/contract/config_error.hpp"
#include "services/device_rig/core/joystick_protocol.hpp"
#include "services/device_rig/core/moteus_can.hpp"
#include "services/device_rig/core/moteus_protocol.hpp"
#include "services/device_rig/core/odrive_protocol.hpp"
#include "services/device_rig/core/parts.hpp"

namespace stillhand::device_rig {

std::unique_ptr<DriveProtocol> protocol_of(const DriveConfig& config, const SettingLimits& limits) {
  switch (drive_of(config)) {
    case Parts::Drive::kOdrive:
      return std::make_unique<odrive::OdriveProtocol>(config, limits);
    case Parts::Drive::kJoystick:
      return std::make_unique<JoystickProtocol>(config, limits);
    case Parts::Drive::kMoteusCan:
      return std::make_unique<moteus::MoteusCan>(config, limits);
    case Parts::Drive::kMoteus:
      break;
  }
  return std::make_unique<moteus::MoteusLines>(config, limits);
}

}  // namespace stillhand::device_rig
