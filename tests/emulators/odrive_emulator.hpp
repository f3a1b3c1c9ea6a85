// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "tests/emulators/drive_emulator.hpp"

namespace stillhand::emulators {

/// Axis 0 of an ODrive by its ASCII protocol, from the maker's document and from what its firmware
/// does (odriverobotics/ODrive at c58aeee: docs/ascii-protocol.md, Firmware/communication/
/// ascii_protocol.cpp, Firmware/MotorControl/{axis,controller,main}.cpp).  It shares no code with
/// the driver.  The motor turns as often as the stick.
class OdriveEmulator final : public DriveEmulator {
 public:
  OdriveEmulator();

  std::string take(std::string_view bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  void sense(const DriveSenses& senses) override { senses_ = senses; }
  [[nodiscard]] double torque_n_m() const override { return torque_n_m_; }
  [[nodiscard]] bool follows() const override { return state_ == kClosedLoop; }
  [[nodiscard]] int mode() const override { return state_; }
  [[nodiscard]] const DriveRecord& record() const override { return record_; }

  void begin(std::int64_t now_ns) override { began_ns_ = fed_ns_ = now_ns; }
  void reboot(std::int64_t now_ns) override;
  /// Bits of axis.error.
  void fault(int code) override;
  void set(const std::string& name, const std::string& value) override { settings_[name] = value; }
  /// The firmware has no "axis0.controller.error".
  void forget(std::uint32_t) override { forgets_ = true; }
  void be(std::uint32_t serial) override { serial_ = serial; }
  void lose_position(bool lost) override;

 private:
  static constexpr int kIdle = 1;
  static constexpr int kClosedLoop = 8;

  std::string answer(std::string line, std::int64_t now_ns);
  std::string execute(const std::string& command, std::int64_t now_ns);
  std::string value_of(const std::string& name, std::int64_t now_ns) const;
  void write(const std::string& name, const std::string& value, std::int64_t now_ns);
  void request(int state, std::int64_t now_ns);
  void command(double torque_n_m, std::int64_t now_ns);
  void disarm();
  void move(std::int64_t now_ns);
  [[nodiscard]] double setting(const char* name) const;

  std::string line_;
  std::map<std::string, std::string> settings_;
  DriveSenses senses_;
  DriveRecord record_;
  int state_ = kIdle;
  int axis_error_ = 0, motor_error_ = 0, encoder_error_ = 0;
  int control_mode_ = 3;  ///< position
  double input_torque_ = 0.0;
  double hold_rev_ = 0.0;
  double torque_n_m_ = 0.0;
  std::string test_property_ = "0";
  std::int64_t began_ns_ = 0, fed_ns_ = 0, command_ns_ = 0;
  bool forgets_ = false;
  bool lost_ = false;
  std::uint32_t serial_ = 0x339d4b42;
};

}  // namespace stillhand::emulators
