// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "display/shell.hpp"

namespace stillhand::display {

/// What happens to the frames.
struct ScreenOptions {
  bool window = false;          ///< show them on the desktop
  bool pointer = false;         ///< publish the mouse over the window
  std::filesystem::path video;  ///< write them here, or empty
};

/// Draws 60 frames a second from the newest data, in the calling thread, until stopped or the
/// window is closed.  Of ordinary priority: a slow window or disk costs frames, never samples.
/// @throws ConfigError when window or file cannot be opened; std::runtime_error once the window was
///         closed.
class ScreenLoop {
 public:
  ScreenLoop(Shell& shell, ScreenOptions options);
  void run();

 private:
  void publish_pointer(Tick tick, std::optional<double> position_m);

  Shell& shell_;
  ScreenOptions options_;
  runtime::Publisher<stillhand_msgs::Pointer> pointer_;
};

}  // namespace stillhand::display
