// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/display/screen_layout.hpp"

namespace stillhand::display {

/// Metres on the screen to pixels of an image and back, Eq. DI-5:
///
///   column = W/2 + s x,   row = H/2 - s y,   s = min(W / width_m, H / height_m)
///
/// One scale for both axes: true proportions, with margins where the image has another shape.
/// Pixels are continuous: pixel i covers [i, i + 1).  x right, y up from the centre [m].  Pure.
class Projection {
 public:
  /// @param columns, rows  W, H [px], at least 16
  /// @throws stillhand::ConfigError when the image or the screen is out of range.
  Projection(const ScreenConfig& screen, int columns, int rows);

  [[nodiscard]] double column_of(double x_m) const noexcept {
    return centre_column_ + scale_ * x_m;
  }
  [[nodiscard]] double row_of(double y_m) const noexcept { return centre_row_ - scale_ * y_m; }
  [[nodiscard]] double x_of(double column) const noexcept {
    return (column - centre_column_) / scale_;
  }
  [[nodiscard]] double y_of(double row) const noexcept { return (centre_row_ - row) / scale_; }
  /// s [px/m].
  [[nodiscard]] double pixels_per_metre() const noexcept { return scale_; }

 private:
  double centre_column_;
  double centre_row_;
  double scale_;
};

}  // namespace stillhand::display
