// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/emulators/iio_side.hpp"
#include "tests/emulators/laboratory.hpp"
#include "tests/emulators/moteus_emulator.hpp"
#include "tests/emulators/serial_side.hpp"

namespace stillhand::emulators {

struct LoopOptions {
  std::filesystem::path drive_link;
  std::uint16_t platform_port = 0;
  bool uart = false;
  std::vector<std::string> settings;  ///< NAME=VALUE
  /// FIFOs of an IIO accelerometer and of a bridge converter; empty: neither
  std::filesystem::path accelerometer, bridge;
};

/// Devices and physics in one thread: it answers whatever comes at once, and steps the physics each
/// millisecond of its own clock.  Lines on standard input make faults and ask for the record.
class EmulatedLoop {
 public:
  EmulatedLoop(const LoopOptions& options, const rig::RigConfig& rig);
  ~EmulatedLoop();
  EmulatedLoop(const EmulatedLoop&) = delete;
  EmulatedLoop& operator=(const EmulatedLoop&) = delete;

  /// Until standard input ends.  @param person  null: nobody holds the stick
  void run(Person* person);

 private:
  void hear_drive(std::int64_t now_ns);
  void hear_platform(std::int64_t now_ns);
  /// @returns false at the end of standard input
  bool hear_orders(std::int64_t now_ns);
  void execute(const std::string& line, std::int64_t now_ns);
  bool execute_drive(const std::string& word, double value, std::int64_t now_ns);
  bool execute_platform(const std::string& word, double value);
  bool execute_laboratory(const std::string& word, double value);
  bool execute_iio(const std::string& word, double value);
  bool execute_way(const std::string& word, double value);
  void report(std::int64_t now_ns) const;

  MoteusEmulator drive_;
  PlatformEmulator platform_;
  SerialSide serial_;
  Laboratory laboratory_;
  std::optional<IioSide> iio_;
  int socket_ = -1;
  bool platform_silent_ = false;
  double platform_loses_ = 0.0;  ///< share of the datagrams, each way
  std::mt19937 dice_{1};
  std::string orders_;
  std::int64_t fault_ns_ = 0;           ///< of the newest order that makes a fault
  double fault_torque_n_m_ = 0.0;       ///< at that moment
  std::int64_t torque_until_ns_ = 0;    ///< newest time with a torque
  std::int64_t platform_until_ns_ = 0;  ///< newest time at which the platform followed
  std::int64_t stepped_ns_ = 0;         ///< newest step
  std::int64_t worst_step_ns_ = 0;      ///< longest time between two steps
};

}  // namespace stillhand::emulators
