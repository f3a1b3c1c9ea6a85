// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/parts.hpp"

#include <array>
#include <string_view>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/mount.hpp"

namespace stillhand::device_rig {
namespace {

/// Place of a word in a list.  @throws ConfigError with the list
template <typename Value, std::size_t N>
Value chosen(const char* setting, const std::string& word,
             const std::array<std::pair<std::string_view, Value>, N>& words) {
  std::string list;
  for (const auto& [name, value] : words) {
    if (word == name) return value;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  throw ConfigError("devices." + std::string(setting), word, "one of " + list);
}

void check_sign(const char* name, std::int64_t sign) {
  if (sign == 0) throw ConfigError("devices." + std::string(name), "0", "1 or -1");
}

void check_signs(const DevicesConfig& config) {
  check_sign("drive.torque_sign", config.drive.torque_sign);
  check_sign("drive.angle_sign", config.drive.angle_sign);
  check_sign("accelerometer.sign", config.accelerometer.sign);
  check_sign("load_cell.sign", config.load_cell.sign);
  if (!config.accelerometer.mount.empty()) {
    const Mount mount("devices.accelerometer.mount", config.accelerometer.mount);
    if (config.accelerometer.sign != 1) {
      throw ConfigError("devices.accelerometer.sign", "-1 with a mount",
                        "1: the mount says which way each axis points");
    }
  }
}

void check_mixture(const Parts& parts, const DevicesConfig& config) {
  using Source = Parts::Source;
  // Without its angle, nobody would see where a motor moves a real stick to.
  if (parts.motor == Parts::Motor::kDrive && parts.angle != Source::kDrive) {
    throw ConfigError("devices.signals.angle", config.signals.angle,
                      "drive, where the motor is the drive");
  }
  if (parts.acceleration == Source::kPlatform && parts.platform != Parts::Platform::kPlain) {
    throw ConfigError("devices.signals.acceleration",
                      "platform with platform " + config.signals.platform,
                      "plain_udp as the platform: no other protocol carries an acceleration");
  }
  if (parts.acceleration == Source::kDrive && parts.force == Source::kDrive &&
      config.drive.acceleration_input == config.drive.force_input) {
    throw ConfigError("devices.drive.acceleration_input",
                      std::to_string(config.drive.acceleration_input) + ", which the force has",
                      "the other connector");
  }
  // A watchdog shorter than two exchanges would trip by itself.
  if (1e3 * config.drive.watchdog_s < 3.0 * static_cast<double>(config.drive.period_ticks)) {
    throw ConfigError("devices.drive.watchdog_s", std::to_string(config.drive.watchdog_s),
                      "at least three times period_ticks");
  }
}

}  // namespace

Parts::Drive drive_of(const DriveConfig& config) {
  using Drive = Parts::Drive;
  constexpr std::array kDrives{std::pair{std::string_view("moteus"), Drive::kMoteus},
                               std::pair{std::string_view("moteus_can"), Drive::kMoteusCan}};
  return chosen("drive.kind", config.kind, kDrives);
}

Parts parts_of(const DevicesConfig& config) {
  using Source = Parts::Source;
  using Motor = Parts::Motor;
  using Platform = Parts::Platform;
  constexpr std::array kStick{std::pair{std::string_view("simulated"), Source::kSimulated},
                              std::pair{std::string_view("drive"), Source::kDrive}};
  constexpr std::array kForces{std::pair{std::string_view("simulated"), Source::kSimulated},
                               std::pair{std::string_view("drive"), Source::kDrive},
                               std::pair{std::string_view("iio"), Source::kIio}};
  constexpr std::array kAccelerometers{std::pair{std::string_view("simulated"), Source::kSimulated},
                                       std::pair{std::string_view("drive"), Source::kDrive},
                                       std::pair{std::string_view("platform"), Source::kPlatform},
                                       std::pair{std::string_view("iio"), Source::kIio}};
  constexpr std::array kMotors{std::pair{std::string_view("simulated"), Motor::kSimulated},
                               std::pair{std::string_view("drive"), Motor::kDrive},
                               std::pair{std::string_view("off"), Motor::kOff}};
  constexpr std::array kPlatforms{std::pair{std::string_view("simulated"), Platform::kSimulated},
                                  std::pair{std::string_view("plain_udp"), Platform::kPlain},
                                  std::pair{std::string_view("moog_udp"), Platform::kMoog}};
  const SignalsConfig& signals = config.signals;
  validate(config, "devices");
  Parts parts{};
  parts.acceleration = chosen("signals.acceleration", signals.acceleration, kAccelerometers);
  parts.force = chosen("signals.force", signals.force, kForces);
  parts.angle = chosen("signals.angle", signals.angle, kStick);
  parts.motor = chosen("signals.motor", signals.motor, kMotors);
  parts.platform = chosen("signals.platform", signals.platform, kPlatforms);
  parts.drive = drive_of(config.drive);
  check_signs(config);
  check_mixture(parts, config);
  return parts;
}

std::vector<std::pair<std::string, std::string>> named_parts(const SignalsConfig& signals) {
  return {{"acceleration", signals.acceleration},
          {"force", signals.force},
          {"angle", signals.angle},
          {"motor", signals.motor},
          {"platform", signals.platform}};
}

std::string in_words(const SignalsConfig& signals) {
  std::string devices;
  std::string simulated;
  for (const auto& [signal, part] : named_parts(signals)) {
    std::string& list = part == "simulated" ? simulated : devices;
    list += (list.empty() ? "" : ", ") + signal;
    if (part != "simulated") list += " " + part;
  }
  if (devices.empty()) return "everything simulated";
  return simulated.empty() ? devices : devices + "; simulated: " + simulated;
}

}  // namespace stillhand::device_rig
