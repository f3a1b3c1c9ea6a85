// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/emulators/serial_side.hpp"

namespace stillhand::emulators {

/// Line of a load cell indicator, "N,+0012.345,g,ST\r\n", for a force.  OL: above 9 kg.
std::string indicator_line(double force_n, bool overload = false);

/// A load cell indicator that is not there: it streams 500 lines a second to a pseudo-terminal and
/// hears nothing.  The format is our own (services/core/device_rig/METHOD.md, DR-36).
class IndicatorSide {
 public:
  explicit IndicatorSide(std::filesystem::path link) : serial_(std::move(link)) {}

  /// One millisecond; every second one sends a line.  Milliseconds that a late caller makes up for
  /// come as a burst, as those of a USB serial chip do.
  void step(double force_n, std::int64_t now_ns);
  void overload(bool overload) { overload_ = overload; }
  SerialSide& serial() { return serial_; }

 private:
  SerialSide serial_;
  std::uint64_t steps_ = 0;
  bool overload_ = false;
};

}  // namespace stillhand::emulators
