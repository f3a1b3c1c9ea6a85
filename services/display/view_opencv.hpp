// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "services/display/core/projection.hpp"
#include "services/display/core/screen_layout.hpp"
#include "services/display/core/tracking_display.hpp"

namespace stillhand::display {

/// What the screen shows the subject in addition to the task.
enum class Notice : std::uint8_t {
  kNone,
  kHold,      ///< a trial is about to start or has ended: hold the stick, nothing to track
  kLinkLost,  ///< no fresh samples: what is drawn is old
};

/// The line of text on the screen.  Holds nothing that reveals the condition: the subject is
/// blinded.
struct ViewStatus {
  std::int64_t trial_number = -1;  ///< counted from 0, shown from 1; -1: none
  double time_left_s = 0.0;        ///< [s] of the measured part
  Notice notice = Notice::kNone;
};

/// The tracking screen as an image: white lines on black, Eq. DI-4 and DI-5.
///
/// Every pixel of a line has the share of its area that the line covers, Eq. DI-7, so that the box
/// moves smoothly however slowly it moves, and lies exactly where the projection says.
/// BGR, 8 bit.  Thread-compatible.  Only this file's .cpp and view_output.cpp see OpenCV's drawing
/// and I/O.
class TrackingView {
 public:
  /// @param columns, rows  size of the image [px]
  /// @throws stillhand::ConfigError when a field or the size is out of range.
  TrackingView(const TrackingDisplay::Config& config, int columns, int rows);

  /// Draws one frame; valid until the next call.  A sample that isn't finite is left out.
  const cv::Mat& draw(const TrackingSample& sample, const ViewStatus& status);

  [[nodiscard]] const Projection& projection() const noexcept { return projection_; }

 private:
  struct TextStyle {
    double height_m;  ///< of a capital
    double grey;      ///< 0 black to 255 white
  };

  void paint(const Bar& bar);
  /// @param share  of the text's length that lies left of x: 0 starts there, 1 ends there
  void write(const std::string& text, double x_m, double share, double baseline_y_m,
             const TextStyle& style);
  void write_status(const ViewStatus& status);

  ScreenConfig screen_;
  ScreenLayout layout_;
  Projection projection_;
  cv::Mat image_;
};

}  // namespace stillhand::display
