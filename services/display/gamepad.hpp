// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace stillhand::display {

/// Values of the axis ABS_X in the bytes of Linux's evdev events, in pieces of any size.
class AxisEvents {
 public:
  /// @return the newest value in these bytes, if there is one
  std::optional<std::int32_t> take(std::span<const std::byte> bytes);

 private:
  std::vector<std::byte> rest_;
};

/// Share of an axis right of its middle, -1 to 1.  @pre low < high
double share_of_axis(std::int32_t value, std::int32_t low, std::int32_t high);

/// The left-right axis (ABS_X) of a gamepad or joystick, without force, by evdev.  One thread.
class Gamepad {
 public:
  /// @param device  for example /dev/input/event5; its axis' range comes from the device, and is
  /// that
  ///                of 16 bits where the device does not say it (a pipe)
  /// @throws ConfigError when it cannot be opened
  explicit Gamepad(const std::filesystem::path& device);
  ~Gamepad();
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;

  /// Newest position, -1 (left) to 1; nothing before the axis first moved, and once the device is
  /// gone.  Does not wait.
  std::optional<double> position();

 private:
  int device_;
  std::int32_t low_ = -32768;
  std::int32_t high_ = 32767;
  AxisEvents events_;
  std::optional<double> newest_;
};

}  // namespace stillhand::display
