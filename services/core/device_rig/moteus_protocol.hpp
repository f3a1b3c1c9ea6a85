// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/drive_protocol.hpp"
#include "services/core/device_rig/fdcanusb_line.hpp"
#include "services/core/device_rig/moteus_drive.hpp"
#include "services/core/device_rig/moteus_settings.hpp"

namespace stillhand::device_rig::moteus {

/// A moteus drive, METHOD Eq. DR-1 and DR-3: orders to frames, frames to states.  How a frame
/// travels is the business of the two classes below.
class MoteusProtocol : public DriveProtocol {
 public:
  MoteusProtocol(const DriveConfig& config, const SettingLimits& limits)
      : config_(config), limits_(limits) {}

  [[nodiscard]] std::string name() const override { return "drive " + std::to_string(config_.id); }
  [[nodiscard]] std::string_view needs() const noexcept override {
    return "a moteus with power, the right id, and its cables";
  }
  std::string_view order(Order order, double torque_n_m) noexcept override;
  [[nodiscard]] std::span<const std::string_view> settings() const noexcept override {
    return kSettings;
  }
  std::string_view ask(std::string_view name) noexcept override;
  std::string_view poll() noexcept override { return packed(poll_setting()); }
  [[nodiscard]] std::optional<std::string> answer() const override { return answer_.line(); }
  [[nodiscard]] std::optional<SettingFault> judge(std::string_view name,
                                                  std::string_view text) const override {
    return judge_setting(name, text, limits_);
  }
  std::string_view ask_serial() noexcept override;
  [[nodiscard]] std::optional<std::string> serial() const override;

 protected:
  /// The bytes that carry a frame to the drive.
  virtual std::string_view packed(const Frame& frame) noexcept = 0;
  /// Takes a frame of the bus.
  void take_frame(std::uint32_t identifier, const Frame& frame, DriveListener& listener) noexcept;
  [[nodiscard]] std::uint32_t destination() const noexcept {
    constexpr std::uint32_t kReplyWanted = 0x8000;
    return kReplyWanted | static_cast<std::uint32_t>(config_.id);
  }

 private:
  DriveConfig config_;
  SettingLimits limits_;
  ConsoleAnswer answer_;
  std::optional<SerialNumber> serial_;
};

/// Through an fdcanusb or the drive's own UART, METHOD Eq. DR-2.
class MoteusLines final : public MoteusProtocol {
 public:
  MoteusLines(const DriveConfig& config, const SettingLimits& limits)
      : MoteusProtocol(config, limits), checked_(config.checksum) {}

  /// The adapter's bus may be off; a drive's UART does not know this command, which does no harm.
  std::string_view greeting() noexcept override { return checked_ ? "" : "\ncan on\n"; }
  [[nodiscard]] std::string_view end_of_piece() const noexcept override { return "\n"; }
  void clear() noexcept override { splitter_ = {}; }
  void take(std::string_view bytes, DriveListener& listener) noexcept override;

 private:
  std::string_view packed(const Frame& frame) noexcept override;

  bool checked_;
  LineSplitter splitter_;
  Line line_;
};

}  // namespace stillhand::device_rig::moteus
