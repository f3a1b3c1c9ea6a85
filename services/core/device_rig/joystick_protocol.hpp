// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"

namespace stillhand::device_rig {

/// A force-feedback joystick by evdev, METHOD Eq. DR-35.  A demonstration: it has no newtons, no
/// measured torque, no current limit and no watchdog of its own, and nothing can be read back.  Its
/// words to the port are records of fixed size, which JoystickPort plays.
class JoystickProtocol final : public DriveProtocol {
 public:
  JoystickProtocol(const DriveConfig& config, const SettingLimits& limits)
      : config_(config), limits_(limits) {}

  [[nodiscard]] std::string name() const override { return "joystick"; }
  [[nodiscard]] std::string_view needs() const noexcept override {
    return "a joystick that plays constant forces";
  }
  void clear() noexcept override {}
  std::string_view order(Order order, double torque_n_m) noexcept override;
  void take(std::string_view bytes, DriveListener& listener) noexcept override;
  [[nodiscard]] std::span<const std::string_view> settings() const noexcept override { return {}; }
  std::string_view ask(std::string_view) noexcept override { return {}; }
  [[nodiscard]] std::optional<std::string> answer() const override { return std::nullopt; }
  [[nodiscard]] std::optional<SettingFault> judge(std::string_view,
                                                  std::string_view) const override {
    return std::nullopt;
  }
  std::string_view ask_serial() noexcept override { return {}; }
  [[nodiscard]] std::optional<std::string> serial() const override { return std::nullopt; }

 private:
  DriveConfig config_;
  SettingLimits limits_;
  std::array<char, 8> record_{};
};

}  // namespace stillhand::device_rig
