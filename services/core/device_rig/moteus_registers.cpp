// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_registers.hpp"

namespace stillhand::device_rig::moteus {
namespace {

/// Steps of int8, int16 and int32.
struct Steps {
  double int8, int16, int32;
};

Steps steps_of(std::uint32_t address) noexcept {
  switch (address) {
    case kPosition:
    case kCommandPosition:
      return {0.01, 1e-4, 1e-5};
    case kVelocity:
    case kCommandVelocity:
      return {0.1, 2.5e-4, 1e-5};
    case kTorque:
    case kCommandTorque:
    case kCommandMaxTorque:
      return {0.5, 0.01, 0.001};
    case kVoltage:
      return {0.5, 0.1, 0.001};
    case kTemperature:
      return {1.0, 0.1, 0.001};
    case kCommandTimeout:
      return {0.01, 0.001, 1e-6};
    case kCommandKpScale:
    case kCommandKdScale:
    case kCommandIlimitScale:
    case kAnalog1:
    case kAnalog2:
      return {1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0};
    default:
      return {1.0, 1.0, 1.0};
  }
}

}  // namespace

double step_of(std::uint32_t address, Resolution resolution) noexcept {
  const Steps steps = steps_of(address);
  switch (resolution) {
    case Resolution::kInt8:
      return steps.int8;
    case Resolution::kInt16:
      return steps.int16;
    case Resolution::kInt32:
      return steps.int32;
    case Resolution::kFloat:
      break;
  }
  return 1.0;
}

bool has_nan(std::uint32_t address) noexcept { return steps_of(address).int16 != 1.0; }

}  // namespace stillhand::device_rig::moteus
