// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "services/processes/display/gamepad.hpp"
#include "services/processes/display/shell.hpp"

namespace stillhand::display {

/// What happens to the frames.
struct ScreenOptions {
  bool window = false;            ///< show them on the desktop
  bool pointer = false;           ///< publish the mouse over the window
  std::filesystem::path gamepad;  ///< publish this device instead; empty: none
  std::filesystem::path video;    ///< write them here, or empty
  std::string rig;                ///< which parts of the rig are devices; empty: none
};

/// Draws 60 frames a second from the newest data, in the calling thread, until stopped or the
/// window is closed.  Of ordinary priority: a slow window or disk costs frames, never samples.
/// Window and file are opened by the constructor, before the service says that it is ready: one
/// that cannot be had refuses the session, and doesn't break it off.
class ScreenLoop {
 public:
  /// @throws ConfigError when window or file cannot be opened.
  ScreenLoop(Shell& shell, ScreenOptions options);
  ~ScreenLoop();
  ScreenLoop(const ScreenLoop&) = delete;
  ScreenLoop& operator=(const ScreenLoop&) = delete;

  /// In the constructor's thread.
  /// @throws std::runtime_error once the window was closed.
  void run();

 private:
  class Screen;

  /// Of gamepad or mouse, on the screen [m].
  [[nodiscard]] std::optional<double> pointed_m();
  void publish_pointer(Tick tick, std::optional<double> position_m);

  Shell& shell_;
  ScreenOptions options_;
  runtime::Publisher<stillhand_msgs::Pointer> pointer_;
  std::optional<Gamepad> gamepad_;
  std::unique_ptr<Screen> screen_;         ///< null when nobody looks
  std::int64_t answered_ns_ = 0;           ///< when an answer was last written
  std::optional<std::int64_t> escape_ns_;  ///< when Escape was pressed
};

}  // namespace stillhand::display
