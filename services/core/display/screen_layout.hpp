// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "services/core/contract/config_field.hpp"

namespace stillhand::display {

/// The monitor and what is drawn on it, in metres of glass.
struct ScreenConfig {
  double width_m = 0.3048;
  double height_m = 0.2286;
  double line_width_m = 0.001;
  double cross_width_m = 0.020;
  double track_above_bottom_m = 0.057;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("width_m", self.width_m, Range{0.10, 2.0},
          "[m] visible width; paper III-C: 15 inch, which is 0.3048 m x 0.2286 m at 4:3");
    visit("height_m", self.height_m, Range{0.08, 2.0}, "[m] visible height, as the width");
    visit("line_width_m", self.line_width_m, Range{0.0002, 0.005},
          "[m] thickness of every line; paper III-C (1 mm)");
    visit("cross_width_m", self.cross_width_m, Range{0.004, 0.1},
          "[m] length of each bar of the cross; the paper gives none, 20 mm stays inside the box");
    visit("track_above_bottom_m", self.track_above_bottom_m, Range{0.02, 1.0},
          "[m] height of box and cross over the lower edge; paper III-C: \"lower part of the "
          "screen\", here a quarter of its height");
  }
};

/// Axis-aligned bar on the screen [m]: x right of the screen's centre, y up from it.
struct Bar {
  double left_m, right_m, bottom_m, top_m;
};

/// Where the lines of target box and cursor cross lie, Eq. DI-4:
///
///   box    four bars whose centre lines form the square |x - x_r| = |y - y_t| = w/2
///   cross  two bars of length c, centred on (x_p, y_t)
///
/// with y_t = track height - screen height / 2.  Source: paper section III-C.  Pure.
class ScreenLayout {
 public:
  /// @param box_width_m  w [m], between the centre lines of the box's sides
  /// @throws stillhand::ConfigError when a field is out of range or the box leaves the screen.
  ScreenLayout(const ScreenConfig& screen, double box_width_m);

  /// Left, right, lower, upper side of the target box.
  [[nodiscard]] std::array<Bar, 4> box(double target_m) const noexcept;
  /// Horizontal and vertical bar of the cursor.
  [[nodiscard]] std::array<Bar, 2> cross(double cursor_m) const noexcept;

 private:
  double half_line_m_;
  double half_box_m_;
  double half_cross_m_;
  double track_y_m_;
};

}  // namespace stillhand::display
