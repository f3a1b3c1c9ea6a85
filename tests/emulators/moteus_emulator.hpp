// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::emulators {

/// What a drive measures.
struct DriveSenses {
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  double analog1 = 0.5;
  double analog2 = 0.5;
};

/// What the drive saw of the host, for tests.
struct DriveRecord {
  std::uint64_t commands = 0;          ///< torque commands of a drive that follows or was asked to
  std::uint64_t stops = 0;             ///< driver off
  std::uint64_t queries = 0;           ///< questions without a command
  std::uint64_t other_modes = 0;       ///< any other mode or state; none is right
  std::uint64_t without_watchdog = 0;  ///< commands that would count for ever
  std::uint64_t with_gains = 0;        ///< commands that leave a gain or a position
  std::uint64_t without_bound = 0;     ///< commands without a largest torque
  std::uint64_t timeouts = 0;
  double most_torque_n_m = 0.0;
  double first_torque_n_m = 0.0;  ///< largest of a first command after a stop
  double torque_after_ms = 0.0;   ///< longest time from a command to the end of its torque
};

/// A moteus drive behind an fdcanusb (or its own UART), by the maker's documents alone: it shares
/// no code with the driver.  The clock is the caller's.  Source: mjbots/moteus,
/// docs/protocol/can.md, registers.md, docs/integration/uart.md, docs/reference/configuration.md.
class MoteusEmulator {
 public:
  /// @param uart  lines end with a checksum, as those of a drive's UART
  explicit MoteusEmulator(bool uart);

  /// Bytes of the host; returns the answer.
  std::string take(std::string_view bytes, std::int64_t now_ns);
  /// The drive's own clock goes on: watchdog and torque.
  void tick(std::int64_t now_ns);
  void sense(const DriveSenses& senses) { senses_ = senses; }
  /// On the stick's shaft.
  [[nodiscard]] double torque_n_m() const { return torque_n_m_; }
  /// Its driver is on and follows commands.
  [[nodiscard]] bool follows() const { return mode_ == 10; }
  [[nodiscard]] int mode() const { return mode_; }
  [[nodiscard]] const DriveRecord& record() const { return record_; }

  /// Its counter is 0 now.
  void begin(std::int64_t now_ns) { began_ns_ = now_ns; }
  /// Off and on again: settings from its memory, counter from 0.
  void reboot(std::int64_t now_ns);
  void fault(int code);
  void set(const std::string& name, const std::string& value) { settings_[name] = value; }
  /// Reading the register is an error.
  void forget(std::uint32_t address) { unknown_ = address; }
  /// Another drive in its place.
  void be(std::uint32_t serial) { serial_ = serial; }
  /// An adapter that lost its power: "can on" has to come again.
  void turn_bus_off() { bus_on_ = false; }
  /// The encoder gives no position.
  void lose_position(bool lost) { lost_ = lost; }

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
  bool bus_on_ = true;
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
