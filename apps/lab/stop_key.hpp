// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <thread>
#include <vector>

namespace stillhand::lab {

/// Finds presses in the bytes of an evdev device (Linux struct input_event, linux/input.h), however
/// they are cut into pieces.  Pure.
class KeyPresses {
 public:
  /// @returns true when a key or button was pressed: type EV_KEY, value 1
  bool take(std::span<const std::byte> bytes);

 private:
  std::vector<std::byte> rest_;
};

/// A key or foot switch for the emergency stop: every key of an evdev device.  A device that can no
/// longer be read, or a pipe that ends, counts as pressed.
class StopKey {
 public:
  /// @param on_press  called once a press was seen, in a thread of this object, every 20 ms for a
  ///                  second
  /// @throws ConfigError when the device cannot be opened.
  StopKey(const std::filesystem::path& device, std::function<void()> on_press);
  ~StopKey();
  StopKey(const StopKey&) = delete;
  StopKey& operator=(const StopKey&) = delete;

 private:
  void watch(const std::stop_token& stop) const;
  [[nodiscard]] bool wait_for_press(const std::stop_token& stop) const;

  int device_;
  std::function<void()> on_press_;
  std::jthread thread_;
};

}  // namespace stillhand::lab
