// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace stillhand::display {

/// What a button does to a question (core/answering.hpp).
///
///   kLeft, kRight  D-pad or hat; shoulder buttons; second and third button of a joystick
///   kConfirm       first button: A of a gamepad, the trigger of a joystick
enum class PadAct : std::uint8_t { kLeft, kRight, kConfirm };

/// Axis and buttons in the bytes of Linux's evdev events, in pieces of any size.
class PadEvents {
 public:
  void take(std::span<const std::byte> bytes);

  /// Newest value of the axis ABS_X; nothing before the first.
  [[nodiscard]] std::optional<std::int32_t> axis() const noexcept { return axis_; }
  /// Presses since the last call, in their order.
  std::vector<PadAct> acts() { return std::exchange(acts_, {}); }

 private:
  std::vector<std::byte> rest_;
  std::optional<std::int32_t> axis_;
  std::vector<PadAct> acts_;
};

/// Share of an axis right of its middle, -1 to 1.  @pre low < high
double share_of_axis(std::int32_t value, std::int32_t low, std::int32_t high);

/// The left-right axis (ABS_X) and the buttons of a gamepad or joystick, without force, by evdev.
/// One thread.
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
  /// What was pressed since the last call.  Does not wait.
  std::vector<PadAct> acts();

 private:
  void read_events();

  int device_;
  std::int32_t low_ = -32768;
  std::int32_t high_ = 32767;
  PadEvents events_;
  std::optional<double> at_start_;  ///< before the first event
  bool gone_ = false;
};

}  // namespace stillhand::display
