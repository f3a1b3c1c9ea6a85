// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace stillhand::display {

/// Type for the screen: DejaVu Sans, drawn by FreeType.  Texts are UTF-8; what the type does not
/// have, and bytes that are no UTF-8, are drawn as its empty box.
/// Thread-compatible.
class Typeface {
 public:
  /// @throws stillhand::ConfigError when the fonts are not installed.
  Typeface();
  ~Typeface();
  Typeface(const Typeface&) = delete;
  Typeface& operator=(const Typeface&) = delete;

  /// Length of a text [px] whose em has that many pixels.
  [[nodiscard]] double width(const std::string& text, double em_px, bool bold);
  /// Draws it; the baseline begins at column and row.
  /// @param image  BGR, 8 bit
  /// @param grey   0 black to 255 white
  void write(cv::Mat& image, const std::string& text, double column, double row, double em_px,
             bool bold, double grey);

 private:
  struct Faces;
  std::unique_ptr<Faces> faces_;
};

}  // namespace stillhand::display
