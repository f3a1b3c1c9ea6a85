// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/joystick_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "services/core/device_rig/joystick_record.hpp"

namespace stillhand::device_rig {
namespace {

constexpr double kMostLevel = 32767.0;

DriveMode mode_of(std::uint32_t mode) noexcept {
  switch (mode) {
    case StickRecord::kOff:
      return DriveMode::kOff;
    case StickRecord::kPlays:
      return DriveMode::kTorque;
    case StickRecord::kRanOut:
      return DriveMode::kTimedOut;
    default:
      return DriveMode::kFault;
  }
}

}  // namespace

std::string_view JoystickProtocol::order(Order order, double torque_n_m) noexcept {
  ForceRecord record;
  if (order == Order::kStop) record.kind = ForceRecord::kStop;
  if (order == Order::kTorque) {
    const double share = config_.max_torque_n_m > 0.0 && std::isfinite(torque_n_m)
                             ? std::clamp(torque_n_m / config_.max_torque_n_m, -1.0, 1.0)
                             : 0.0;
    record.kind = ForceRecord::kPlay;
    record.level = static_cast<std::int16_t>(std::lround(kMostLevel * config_.gain * share));
    record.length_ms = static_cast<std::uint16_t>(std::lround(1e3 * config_.watchdog_s));
  }
  std::memcpy(record_.data(), &record, sizeof(record));
  return {record_.data(), record_.size()};
}

void JoystickProtocol::take(std::string_view bytes, DriveListener& listener) noexcept {
  const auto record = record_in<StickRecord>(bytes);
  const double range = record ? static_cast<double>(record->highest) - record->lowest : 0.0;
  if (!(range > 0.0)) return listener.damaged();
  DriveReply reply;
  reply.mode = mode_of(record->mode);
  reply.fault = reply.mode == DriveMode::kFault ? 1 : 0;
  // Its ends are the stops of the stick that it stands for.
  const double share = 2.0 * (static_cast<double>(record->value) - record->lowest) / range - 1.0;
  reply.position_rev = limits_.travel_rev * share;
  reply.milliseconds = static_cast<int>(record->milliseconds & 0xffffu);
  reply.whole = true;
  listener.state(reply);
}

}  // namespace stillhand::device_rig
