// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/libraries/report/plot/axis_layout.hpp"

namespace stillhand::report {
namespace {

void include(Extent& extent, const Axis& axis, double value) {
  if (!(std::abs(value) <= kLargestValue)) return;
  if (axis.scale == Scale::kLogarithmic && value <= 0.0) return;
  extent.low = std::min(extent.low, value);
  extent.high = std::max(extent.high, value);
}

bool has_marks(Kind kind) {
  return kind == Kind::kPoints || kind == Kind::kLineAndPoints || kind == Kind::kErrorBars ||
         kind == Kind::kBars || kind == Kind::kBox;
}

void include_lines(Extent& extent, const Axis& axis, const Panel& panel, Direction direction) {
  for (const ReferenceLine& line : panel.reference_lines) {
    if (line.direction == direction) include(extent, axis, line.at);
  }
}

void include_box(Extent& extent, const Axis& axis, const Box& box) {
  for (const double value :
       {box.low, box.lower_quartile, box.median, box.upper_quartile, box.high}) {
    include(extent, axis, value);
  }
}

}  // namespace

Extent extent_x(const Panel& panel) {
  Extent extent;
  for (const Series& series : panel.series) {
    extent.marks = extent.marks || has_marks(series.kind);
    const double half_width = series.kind == Kind::kBars ? 0.5 * series.bar_width : 0.0;
    for (const double x : series.x) {
      include(extent, panel.x, x - half_width);
      include(extent, panel.x, x + half_width);
    }
    for (const Box& box : series.boxes) {
      include(extent, panel.x, box.at - 0.5 * series.bar_width);
      include(extent, panel.x, box.at + 0.5 * series.bar_width);
    }
  }
  include_lines(extent, panel.x, panel, Direction::kVertical);
  return extent;
}

Extent extent_y(const Panel& panel) {
  Extent extent;
  const auto visible = [&](double x) {
    return !(panel.x.low && x < *panel.x.low) && !(panel.x.high && x > *panel.x.high);
  };
  for (const Series& series : panel.series) {
    extent.marks = extent.marks || has_marks(series.kind);
    if (series.kind == Kind::kBars) {
      extent.from_zero = true;
      include(extent, panel.y, 0.0);
    }
    for (const std::vector<double>* values : {&series.y, &series.y_low, &series.y_high}) {
      for (std::size_t i = 0; i < values->size() && i < series.x.size(); ++i) {
        if (visible(series.x[i])) include(extent, panel.y, (*values)[i]);
      }
    }
    for (const Box& box : series.boxes) {
      if (visible(box.at)) include_box(extent, panel.y, box);
    }
  }
  include_lines(extent, panel.y, panel, Direction::kHorizontal);
  return extent;
}

}  // namespace stillhand::report
