// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

/// Look of a role.  Conditions also differ in shape, so a figure is readable in grey.
struct Look {
  std::string_view rgb;  ///< "#rrggbb"
  int point_type;        ///< gnuplot's number of a filled shape
};

/// Colours of the conditions: Okabe and Ito, "Color Universal Design" (2008), which people with any
/// of the common colour deficiencies can distinguish.  F is their yellow, darkened to be legible on
/// white.  The other roles are darker than every condition, so they differ in lightness.
constexpr Look look(Colour colour) {
  constexpr int kSquare = 5;
  constexpr int kCircle = 7;
  constexpr int kTriangle = 9;
  constexpr int kTriangleDown = 11;
  constexpr int kDiamond = 13;
  constexpr int kPentagon = 15;
  // In the order of Colour.
  constexpr std::array<Look, 14> kLooks{{{"#0072b2", kCircle},
                                         {"#d55e00", kSquare},
                                         {"#009e73", kTriangle},
                                         {"#7fb800", kTriangleDown},
                                         {"#cc79a7", kDiamond},
                                         {"#e69f00", kTriangleDown},
                                         {"#56b4e9", kPentagon},
                                         {"#9a8700", kCircle},
                                         {"#5b2a86", kDiamond},
                                         {"#4d4d4d", kCircle},
                                         {"#111111", kSquare},
                                         {"#808080", kCircle},
                                         {"#005f73", kTriangle},
                                         {"#a4001d", kTriangleDown}}};
  static_assert(kLooks.size() == static_cast<std::size_t>(Colour::kWarning) + 1);
  return kLooks[static_cast<std::size_t>(colour)];
}

/// Lines and letters around the data.
inline constexpr std::string_view kTextRgb = "#222222";
inline constexpr std::string_view kFrameRgb = "#666666";
inline constexpr std::string_view kGridRgb = "#dedede";
inline constexpr std::string_view kMinorGridRgb = "#efefef";

}  // namespace stillhand::report
