// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "services/core/display/page.hpp"
#include "services/core/display/page_layout.hpp"
#include "services/core/display/projection.hpp"
#include "services/core/display/screen_layout.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/processes/display/view_text.hpp"

namespace stillhand::display {

/// The tracking screen as an image: white lines and words on black, Eq. DI-4, DI-5 and DI-9.
///
/// Every pixel of a line has the share of its area that the line covers, Eq. DI-7, so that the box
/// moves smoothly however slowly it moves, and lies exactly where the projection says.  Words are
/// drawn when they change, and copied otherwise.
/// BGR, 8 bit.  Thread-compatible.  Only this file's .cpp, view_text.cpp and view_output.cpp see
/// OpenCV's drawing and I/O.
class TrackingView {
 public:
  /// @param columns, rows  size of the image [px]
  /// @throws stillhand::ConfigError when a field or the size is out of range, or a font is missing.
  TrackingView(const TrackingDisplay::Config& config, int columns, int rows);

  /// Draws one frame; valid until the next call.  A sample that isn't finite is left out.
  const cv::Mat& draw(const TrackingSample& sample, const Page& page);
  /// Value of the box of the newest page at a place on the screen [m]; nothing: none is there.
  [[nodiscard]] std::optional<std::int64_t> box_at(double x_m, double y_m) const {
    return page_layout_.box_at(x_m, y_m);
  }

  [[nodiscard]] const Projection& projection() const noexcept { return projection_; }

 private:
  void paint(const Bar& bar);
  void paint(const PlacedBox& box);
  void write(const PlacedText& text);
  /// The words of a page, into words_.
  void draw_words(const Page& page);

  ScreenConfig screen_;
  ScreenLayout layout_;
  Projection projection_;
  Typeface typeface_;
  std::optional<Page> page_;  ///< whose words words_ holds
  PageLayout page_layout_;
  cv::Mat words_, image_;
};

}  // namespace stillhand::display
