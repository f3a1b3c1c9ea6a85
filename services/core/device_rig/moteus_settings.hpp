// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "services/core/device_rig/drive_protocol.hpp"
#include "services/core/device_rig/moteus_frame.hpp"

namespace stillhand::device_rig::moteus {

/// Names that are read back through the configuration console.
inline constexpr std::array<std::string_view, 6> kSettings{
    "servo.timeout_mode",       "servo.default_timeout_s", "servo.max_current_A",
    "servo.fixed_voltage_mode", "servopos.position_min",   "servopos.position_max"};

/// @param text  the console's answer to "conf get NAME"
/// @returns nothing if the setting is right
std::optional<SettingFault> judge_setting(std::string_view name, std::string_view text,
                                          const SettingLimits& limits);

/// "conf get NAME" to the console.
Frame ask_setting(std::string_view name) noexcept;
/// Asks for the console's answer.
Frame poll_setting() noexcept;

/// Collects the console's answer, which comes in pieces.
class ConsoleAnswer {
 public:
  void take(std::span<const std::uint8_t> text);
  /// The first whole line, without its end; nothing before it is there.
  [[nodiscard]] std::optional<std::string> line() const;
  void clear() { text_.clear(); }

 private:
  std::string text_;
};

}  // namespace stillhand::device_rig::moteus
