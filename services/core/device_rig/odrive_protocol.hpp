// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"
#include "services/core/device_rig/line_splitter.hpp"
#include "services/core/device_rig/odrive_exchange.hpp"
#include "services/core/device_rig/odrive_settings.hpp"

namespace stillhand::device_rig::odrive {

/// An axis of an ODrive by its ASCII protocol, firmware 0.5.3 to 0.5.x, METHOD Eq. DR-30 to DR-32.
/// Torque is "c", which alone feeds the watchdog here; "u", which would prolong an old torque, is
/// never sent, nor "p", "q", "v" or "t".
class OdriveProtocol final : public DriveProtocol {
 public:
  OdriveProtocol(const DriveConfig& config, const SettingLimits& limits);

  [[nodiscard]] std::string name() const override {
    return "axis " + std::to_string(config_.axis) + " of the ODrive";
  }
  [[nodiscard]] std::string_view needs() const noexcept override {
    return "an ODrive of firmware 0.5.3 to 0.5.x with power, its ASCII protocol on this port, and "
           "its cables";
  }
  std::string_view greeting() noexcept override { return "\n"; }
  [[nodiscard]] std::string_view end_of_piece() const noexcept override { return "\n"; }
  void clear() noexcept override;
  std::string_view order(Order order, double torque_n_m) noexcept override;
  void take(std::string_view bytes, DriveListener& listener) noexcept override;
  [[nodiscard]] std::span<const std::string_view> settings() const noexcept override {
    return settings_of(axis_);
  }
  std::string_view ask(std::string_view name) noexcept override;
  [[nodiscard]] std::optional<std::string> answer() const override { return answer_; }
  [[nodiscard]] std::optional<SettingFault> judge(std::string_view name,
                                                  std::string_view text) const override;
  std::string_view ask_serial() noexcept override;
  [[nodiscard]] std::optional<std::string> serial() const override { return serial_; }

 private:
  /// Who gets the next line.
  enum class Asked : std::uint8_t { kState, kSetting, kSerial };
  /// An error word of the drive and its name.
  struct Word {
    const char* name;
    std::uint64_t bits = 0;
  };

  void take_line(std::string_view line, DriveListener& listener) noexcept;
  void take_setting(std::string_view text) noexcept;
  [[nodiscard]] DriveReply reply_of(const Answers& answers) noexcept;
  void stop() noexcept;
  void torque(double torque_n_m) noexcept;

  DriveConfig config_;
  std::size_t axis_;
  Lines lines_;
  LineSplitter splitter_;
  AnswerReader reader_;
  Asked asked_ = Asked::kState;
  std::optional<std::string> answer_, serial_;
  std::uint64_t setting_number_ = 0;
  bool asks_constant_ = false;
  std::optional<std::string> between_;  ///< the line behind the number; empty: none yet
  double torque_constant_n_m_a_ = 0.0;
  /// The exchange that armed the axis; nothing: it is not armed.
  std::optional<std::uint64_t> armed_in_;
  std::array<Word, 4> errors_;  ///< axis, motor, encoder, controller
  double current_a_ = DriveReply::kNone;
};

}  // namespace stillhand::device_rig::odrive
