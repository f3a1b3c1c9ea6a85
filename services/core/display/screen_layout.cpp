// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/screen_layout.hpp"

#include <algorithm>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {

ScreenLayout::ScreenLayout(const ScreenConfig& screen, double box_width_m)
    : half_line_m_(screen.line_width_m / 2.0),
      half_box_m_(box_width_m / 2.0),
      half_cross_m_(screen.cross_width_m / 2.0),
      track_y_m_(screen.track_above_bottom_m - screen.height_m / 2.0) {
  validate(screen, "display.screen");
  const double half_tall_m = std::max(half_box_m_ + half_line_m_, half_cross_m_);
  if (screen.track_above_bottom_m < half_tall_m ||
      screen.track_above_bottom_m > screen.height_m - half_tall_m) {
    throw ConfigError("display.screen.track_above_bottom_m",
                      std::to_string(screen.track_above_bottom_m),
                      "a height at which box and cross lie inside the screen");
  }
}

std::array<Bar, 4> ScreenLayout::box(double target_m) const noexcept {
  const double inner_m = half_box_m_ - half_line_m_;
  const double outer_m = half_box_m_ + half_line_m_;
  const auto bar = [&](double left, double right, double bottom, double top) {
    return Bar{target_m + left, target_m + right, track_y_m_ + bottom, track_y_m_ + top};
  };
  return {bar(-outer_m, -inner_m, -outer_m, outer_m), bar(inner_m, outer_m, -outer_m, outer_m),
          bar(-outer_m, outer_m, -outer_m, -inner_m), bar(-outer_m, outer_m, inner_m, outer_m)};
}

std::array<Bar, 2> ScreenLayout::cross(double cursor_m) const noexcept {
  return {Bar{cursor_m - half_cross_m_, cursor_m + half_cross_m_, track_y_m_ - half_line_m_,
              track_y_m_ + half_line_m_},
          Bar{cursor_m - half_line_m_, cursor_m + half_line_m_, track_y_m_ - half_cross_m_,
              track_y_m_ + half_cross_m_}};
}

}  // namespace stillhand::display
