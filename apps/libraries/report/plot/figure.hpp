// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Content of a figure as plain structs; draw.hpp draws it.  All texts are UTF-8 and literal (no
/// markup: a unit is written "m/s²"); a control character becomes a space. Numbers are in the unit
/// that the axis label names.  A value that is not finite, or not positive on a logarithmic axis,
/// is a gap.
namespace stillhand::report {

/// Role of a mark.  A role has the same colour and point shape in every figure.
enum class Colour {
  kConditionA,
  kConditionB,
  kConditionC,
  kConditionCPrime,
  kConditionCPlus,
  kConditionD,
  kConditionE,
  kConditionF,
  kModel,
  kMeasured,
  kTarget,
  kNeutral,
  kAccent,
  kWarning
};

/// A labelled place on an axis; an empty label is the number itself.
struct AxisTick {
  double at = 0.0;
  std::string label = {};
};

enum class Scale {
  kLinear,
  kLogarithmic,  ///< ticks at 1, 2, 5 times a power of ten where there is room
  kDegrees       ///< a phase: limits and ticks at multiples of 45 (15, 90, 180 where that fits)
};

struct Axis {
  std::string label = {};
  Scale scale = Scale::kLinear;
  std::optional<double> low = {};  ///< limits; by default from the values shown
  std::optional<double> high = {};
  std::vector<AxisTick> ticks = {};      ///< replace the automatic ticks, for example by categories
  std::optional<double> tick_step = {};  ///< distance of automatic ticks, linear and degrees only
};

/// The fields of Series that a kind needs are in brackets; arrays of one series are equally long.
enum class Kind {
  kLine,           ///< [x, y]
  kDashedLine,     ///< [x, y]
  kDottedLine,     ///< [x, y]
  kPoints,         ///< [x, y]
  kLineAndPoints,  ///< [x, y]
  kSteps,          ///< [x, y] y holds until the next x
  kBand,           ///< [x, y_low, y_high] translucent
  kErrorBars,      ///< [x, y, y_low, y_high] y_low and y_high are the bar's ends, not lengths
  kBars,           ///< [x, y] from zero
  kBox             ///< [boxes]
};

/// Five numbers; the whiskers reach from the lowest to the highest.
struct Box {
  double at = 0.0;  ///< place on the x axis, mostly a category's number
  double low = 0.0;
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double high = 0.0;
};

struct Series {
  std::string label = {};
  Kind kind = Kind::kLine;
  Colour colour = Colour::kNeutral;
  std::vector<double> x = {};
  std::vector<double> y = {};
  std::vector<double> y_low = {};
  std::vector<double> y_high = {};
  std::vector<Box> boxes = {};
  double line_width_px = 1.8;
  double point_size = 1.0;  ///< [-] 1 is a mark about 7 px wide
  double bar_width = 0.6;   ///< of bars and boxes, in units of x
  bool show_in_legend = true;
};

enum class Direction { kHorizontal, kVertical };

/// A dashed line across the panel, with its label inside at one end.
struct ReferenceLine {
  Direction direction = Direction::kHorizontal;
  double at = 0.0;
  std::string label = {};
  Colour colour = Colour::kNeutral;
};

enum class Corner { kTopLeft, kTopRight, kBottomLeft, kBottomRight };

/// One line of text: in a corner of the panel (several stack), or right of a point when `at` is
/// given.
struct Note {
  std::string text = {};
  Corner corner = Corner::kTopLeft;
  std::optional<std::pair<double, double>> at = {};  ///< (x, y) in units of the axes
};

enum class Legend { kAbove, kTopLeft, kTopRight, kBottomLeft, kBottomRight, kNone };

struct Panel {
  std::string title = {};
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};  ///< drawn in this order, so a band comes first
  std::vector<ReferenceLine> reference_lines = {};
  std::vector<Note> notes = {};
  bool equal_aspect = false;  ///< one unit is as long on x as on y; linear axes only
  Legend legend = Legend::kAbove;
  bool blank = false;  ///< nothing is drawn; the place in the row stays empty
};

/// Panels fill rows from the left; plots of one column are aligned, all are equally high.
struct Figure {
  std::string name = {};     ///< file stem and id: letters, digits, '-' and '_', not empty
  std::string caption = {};  ///< below the figure on a page; not in the picture
  std::vector<Panel> panels = {};
  int columns = 1;
  int width_px = 860;
  int height_px = 360;
};

}  // namespace stillhand::report
