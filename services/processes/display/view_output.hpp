// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/display/projection.hpp"

namespace stillhand::display {

/// A video of the frames, in Motion JPEG.  Thread-compatible.
class FrameFile {
 public:
  /// @param path     ends in .avi
  /// @param rate_hz  frames a second, 1 to 240
  /// @throws stillhand::ConfigError when the ending is another, the folder isn't writable or the
  ///         codec is missing.
  FrameFile(const std::string& path, double rate_hz, int columns, int rows);

  /// @param frame  BGR, 8 bit, of the announced size
  /// @return false when it could not be written
  [[nodiscard]] bool write(const cv::Mat& frame);

 private:
  cv::VideoWriter video_;
};

/// A place on the screen [m]: x right of its centre, y up from it.
struct ScreenPlace {
  double x_m, y_m;
};

inline constexpr char kEnterKey = '\n';

/// A window on the desktop that shows frames and knows where the pointer is over it.
/// One thread: the one that makes it also shows, since the window system asks so.
class ScreenWindow {
 public:
  /// @param projection  that of the frames to come
  /// @throws stillhand::ConfigError when there is no display or no window can be made on it.
  ScreenWindow(const std::string& title, const Projection& projection, bool full_screen);
  ~ScreenWindow();
  ScreenWindow(const ScreenWindow&) = delete;
  ScreenWindow& operator=(const ScreenWindow&) = delete;

  /// Shows a frame and lets the window system work for about a millisecond.
  /// @return false once the window was closed, or q pressed in it.
  [[nodiscard]] bool show(const cv::Mat& frame);

  /// Pointer on the screen, right of its centre [m]; nothing before it first moved over the window.
  [[nodiscard]] std::optional<double> pointer_m() const noexcept { return pointer_m_; }

  /// Keys pressed since the last call, in their order: printable ones, and kEnterKey.
  [[nodiscard]] std::vector<char> keys() { return std::exchange(keys_, {}); }
  /// Where the left button was pressed since the last call, the last one; on the screen [m].
  [[nodiscard]] std::optional<ScreenPlace> click() { return std::exchange(click_, std::nullopt); }

  /// Escape was pressed since the last call.
  [[nodiscard]] bool escape_pressed() noexcept { return std::exchange(escape_, false); }

 private:
  static void on_mouse(int event, int column, int row, int flags, void* window);

  std::string title_;
  Projection projection_;
  std::optional<double> pointer_m_;
  std::vector<char> keys_;
  std::optional<ScreenPlace> click_;
  bool escape_ = false;
  bool sized_;  ///< the window has its size: full screen, or the first frame's
};

}  // namespace stillhand::display
