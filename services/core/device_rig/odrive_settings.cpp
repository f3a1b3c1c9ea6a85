// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/odrive_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "services/core/device_rig/odrive_line.hpp"

namespace stillhand::device_rig::odrive {
namespace {

constexpr std::size_t kCount = 25;
/// Of the device, then of the axis; whole names, so that a question needs no putting together.
constexpr std::array<std::string_view, kCount> kAxis0{
    "fw_version_major", "fw_version_minor", "fw_version_revision", "axis0.motor.is_calibrated",
    "axis0.encoder.is_ready", "axis0.config.enable_watchdog", "axis0.config.watchdog_timeout",
    "axis0.motor.config.current_lim", "axis0.motor.config.torque_lim",
    "axis0.motor.config.torque_constant", "axis0.controller.config.input_mode",
    "axis0.controller.config.enable_torque_mode_vel_limit", "axis0.config.enable_sensorless_mode",
    "axis0.config.startup_closed_loop_control", "axis0.config.startup_motor_calibration",
    "axis0.config.startup_encoder_index_search", "axis0.config.startup_encoder_offset_calibration",
    "axis0.config.startup_homing",
    // What each exchange asks for: a number, of whatever value.
    "system_stats.uptime", "axis0.current_state", "axis0.error", "axis0.motor.error",
    "axis0.encoder.error", "axis0.controller.error", "axis0.motor.current_control.Iq_measured"};
constexpr std::array<std::string_view, kCount> kAxis1{
    "fw_version_major", "fw_version_minor", "fw_version_revision", "axis1.motor.is_calibrated",
    "axis1.encoder.is_ready", "axis1.config.enable_watchdog", "axis1.config.watchdog_timeout",
    "axis1.motor.config.current_lim", "axis1.motor.config.torque_lim",
    "axis1.motor.config.torque_constant", "axis1.controller.config.input_mode",
    "axis1.controller.config.enable_torque_mode_vel_limit", "axis1.config.enable_sensorless_mode",
    "axis1.config.startup_closed_loop_control", "axis1.config.startup_motor_calibration",
    "axis1.config.startup_encoder_index_search", "axis1.config.startup_encoder_offset_calibration",
    "axis1.config.startup_homing",
    // What each exchange asks for: a number, of whatever value.
    "system_stats.uptime", "axis1.current_state", "axis1.error", "axis1.motor.error",
    "axis1.encoder.error", "axis1.controller.error", "axis1.motor.current_control.Iq_measured"};

/// A setting that must be one number.
struct Exact {
  std::string_view name;  ///< behind "axisN."
  double value;
  const char* because;
};
constexpr std::array<Exact, 9> kExact{{
    {"config.enable_watchdog", 1, "1: without its watchdog a torque lasts for ever"},
    {"controller.config.input_mode", 1, "1: the torque is passed through as it is commanded"},
    {"controller.config.enable_torque_mode_vel_limit", 0,
     "0: with it the torque depends on the velocity"},
    {"config.enable_sensorless_mode", 0, "0: with it the drive spins the motor to begin"},
    {"config.startup_closed_loop_control", 0, "0: nothing arms by itself"},
    {"config.startup_motor_calibration", 0, "0: the stick does not move when the drive starts"},
    {"config.startup_encoder_index_search", 0, "0: the stick does not move when the drive starts"},
    {"config.startup_encoder_offset_calibration", 0,
     "0: the stick does not move when the drive starts"},
    {"config.startup_homing", 0, "0: the stick does not move when the drive starts"},
}};

std::string write(std::string_view name, double value) {
  return fmt::format("w {} {:g}, then ss (saves, and starts the drive again)", name, value);
}

/// The setting lies in (0, most].
std::optional<SettingFault> at_most(std::string_view name, std::string_view text, double most,
                                    const char* unit, const char* from) {
  const auto value = real_of(text);
  // The drive answers with six decimals, so what it was given may come back rounded up.
  constexpr double kHalfDecimal = 5e-7;
  if (value && *value > 0.0 && *value <= most + kHalfDecimal) return std::nullopt;
  return SettingFault{std::string(name), std::string(text),
                      fmt::format("more than 0 and at most {:g} {} ({})", most, unit, from),
                      write(name, most)};
}

std::optional<SettingFault> judge_version(std::string_view name, std::string_view text) {
  // 0.5.3 ends an answer with a checksum by a newline, too (odriverobotics/ODrive, issue 596).
  const auto value = whole_of(text);
  const bool good = name == "fw_version_major"   ? value == 0u
                    : name == "fw_version_minor" ? value == 5u
                                                 : value && *value >= 3;
  if (good) return std::nullopt;
  return SettingFault{std::string(name), std::string(text),
                      "firmware 0.5.3 to 0.5.x: others have other properties",
                      "the maker's tool, odrivetool dfu"};
}

}  // namespace

std::span<const std::string_view> settings_of(std::size_t axis) noexcept {
  return axis == 0 ? kAxis0 : kAxis1;
}

std::optional<SettingFault> judge_setting(std::string_view name, std::string_view text,
                                          const DriveConfig& config) {
  if (name.starts_with("fw_version")) return judge_version(name, text);
  const std::string_view own = name.substr(std::min(name.find('.') + 1, name.size()));
  const auto value = real_of(text);
  for (const Exact& each : kExact) {
    if (own != each.name || value == each.value) continue;
    return SettingFault{std::string(name), std::string(text), each.because,
                        write(name, each.value)};
  }
  if (own == "motor.is_calibrated" || own == "encoder.is_ready") {
    if (value == 1.0) return std::nullopt;
    return SettingFault{std::string(name), std::string(text), "1: calibrated",
                        fmt::format("w {}.requested_state 3, hand off: the motor turns",
                                    name.substr(0, name.find('.')))};
  }
  if (own == "config.watchdog_timeout") {
    return at_most(name, text, config.watchdog_s, "s", "drive.watchdog_s");
  }
  if (own == "motor.config.current_lim") {
    return at_most(name, text, config.max_current_a, "A", "drive.max_current_a");
  }
  if (own == "motor.config.torque_lim") {
    return at_most(name, text, config.max_torque_n_m / config.ratio, "N m",
                   "drive.max_torque_n_m over drive.ratio");
  }
  if (own == "motor.config.torque_constant" && !(value && *value > 0.0)) {
    return SettingFault{std::string(name), std::string(text),
                        "more than 0: torque of the motor per ampere",
                        "the motor's own: 8.27 / KV"};
  }
  if (!value || !std::isfinite(*value)) {
    return SettingFault{std::string(name), std::string(text), "a number",
                        "another firmware of 0.5 (odrivetool dfu)"};
  }
  return std::nullopt;
}

}  // namespace stillhand::device_rig::odrive
