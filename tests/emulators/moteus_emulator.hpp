// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/emulators/drive_emulator.hpp"

namespace stillhand::emulators {

/// A moteus drive behind an fdcanusb (or its own UART), by the maker's documents alone: it shares
/// no code with the driver.  The clock is the caller's.  Source: mjbots/moteus,
/// docs/protocol/can.md, registers.md, docs/integration/uart.md, docs/reference/configuration.md.
class MoteusEmulator final : public DriveEmulator {
 public:
  /// @param uart  lines end with a checksum, as those of a drive's UART
  explicit MoteusEmulator(bool uart);

  std::string take(std::string_view bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  void sense(const DriveSenses& senses) override { senses_ = senses; }
  [[nodiscard]] double torque_n_m() const override { return torque_n_m_; }
  [[nodiscard]] bool follows() const override { return mode_ == 10; }
  [[nodiscard]] int mode() const override { return mode_; }
  [[nodiscard]] const DriveRecord& record() const override { return record_; }

  void begin(std::int64_t now_ns) override { began_ns_ = now_ns; }
  void reboot(std::int64_t now_ns) override;
  void fault(int code) override;
  void set(const std::string& name, const std::string& value) override { settings_[name] = value; }
  /// Reading the register is an error.
  void forget(std::uint32_t address) override { unknown_ = address; }
  void be(std::uint32_t serial) override { serial_ = serial; }
  void lose_position(bool lost) override { lost_ = lost; }

 private:
  struct Command;
  std::string answer(std::string line, std::int64_t now_ns);
  std::vector<std::uint8_t> frame(const std::vector<std::uint8_t>& payload, std::int64_t now_ns);
  void execute(const Command& command, std::int64_t now_ns);
  void torque(std::int64_t now_ns);
  void console(std::string_view text);
  [[nodiscard]] double of_register(std::uint32_t address, std::int64_t now_ns) const;
  [[nodiscard]] double setting(const char* name) const;

  bool uart_;
  bool checked_ = false;  ///< a command came with a checksum: from now on all need one
  std::string line_;
  std::map<std::string, std::string> settings_;
  std::string console_in_, console_out_;
  DriveSenses senses_;
  DriveRecord record_;
  int mode_ = 0;
  int fault_ = 0;
  std::int64_t began_ns_ = 0;
  std::int64_t command_ns_ = 0;
  double watchdog_s_ = 0.0;
  double torque_n_m_ = 0.0;
  // Of the newest command in mode 10.
  double hold_rev_ = 0.0, kp_ = 0.0, kd_ = 0.0, forward_n_m_ = 0.0;
  double most_n_m_ = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t since_stop_ = 0;  ///< commands
  std::uint32_t unknown_ = 0xffff;
  bool lost_ = false;
  std::uint32_t serial_ = 0x1d003a;  ///< least significant word
};

}  // namespace stillhand::emulators
