// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  switch (colour) {
    case Colour::kConditionA:
      return {"#0072b2", kCircle};
    case Colour::kConditionB:
      return {"#d55e00", kSquare};
    case Colour::kConditionC:
      return {"#009e73", kTriangle};
    case Colour::kConditionCPrime:
      return {"#7fb800", kTriangleDown};
    case Colour::kConditionCPlus:
      return {"#cc79a7", kDiamond};
    case Colour::kConditionD:
      return {"#e69f00", kTriangleDown};
    case Colour::kConditionE:
      return {"#56b4e9", kPentagon};
    case Colour::kConditionF:
      return {"#9a8700", kCircle};
    case Colour::kModel:
      return {"#5b2a86", kDiamond};
    case Colour::kMeasured:
      return {"#4d4d4d", kCircle};
    case Colour::kTarget:
      return {"#111111", kSquare};
    case Colour::kNeutral:
      return {"#808080", kCircle};
    case Colour::kAccent:
      return {"#005f73", kTriangle};
    case Colour::kWarning:
      return {"#a4001d", kTriangleDown};
  }
  return {"#000000", kCircle};
}

/// Lines and letters around the data.
inline constexpr std::string_view kTextRgb = "#222222";
inline constexpr std::string_view kFrameRgb = "#666666";
inline constexpr std::string_view kGridRgb = "#dedede";
inline constexpr std::string_view kMinorGridRgb = "#efefef";

}  // namespace stillhand::report
