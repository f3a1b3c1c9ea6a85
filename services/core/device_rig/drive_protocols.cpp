// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/drive_protocols.hpp"

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/moteus_can.hpp"
#include "services/core/device_rig/moteus_protocol.hpp"
#include "services/core/device_rig/parts.hpp"

namespace stillhand::device_rig {

std::unique_ptr<DriveProtocol> protocol_of(const DriveConfig& config, const SettingLimits& limits) {
  switch (drive_of(config)) {
    case Parts::Drive::kMoteusCan:
      return std::make_unique<moteus::MoteusCan>(config, limits);
    case Parts::Drive::kMoteus:
      break;
  }
  return std::make_unique<moteus::MoteusLines>(config, limits);
}

}  // namespace stillhand::device_rig
