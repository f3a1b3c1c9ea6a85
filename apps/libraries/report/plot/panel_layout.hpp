// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/libraries/report/plot/axis_layout.hpp"
#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

inline constexpr double kFontSize_px = 13.0;
inline constexpr double kSmallFontSize_px = 11.5;

/// A rectangle of the picture [px]; y counts downwards from the top edge.
struct Rectangle {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
};

/// One entry of a legend: its series, and the start of its sample.
struct LegendEntry {
  std::size_t series = 0;
  double left_px = 0.0;
  double middle_px = 0.0;
};

/// Places of all parts of one panel.
struct PanelLayout {
  Rectangle plot;  ///< inside the axes
  AxisLayout x;
  AxisLayout y;
  bool slanted_x_labels = false;         ///< they would overlap side by side
  double y_label_px = 0.0;               ///< centre line of the y axis label, from the left edge
  double x_label_px = 0.0;               ///< centre line of the x axis label, from the top edge
  double title_px = 0.0;                 ///< centre line of the title, from the top edge
  Legend legend_place = Legend::kAbove;  ///< as requested, or above if a corner has no room
  Rectangle legend;                      ///< background of a legend inside the plot; else empty
  std::vector<LegendEntry> entries;
};

/// Places the panels of a figure so that no text covers another: margins follow from the widths of
/// labels (estimated, DejaVu Sans), plots of a column share their left edge, plots of a row their
/// top, all have the same height.  Pure.
std::vector<PanelLayout> lay_out(const Figure& figure);

/// From an axis to its tick labels [px].
inline constexpr double kTickToLabel_px = 9.0;
/// Slant of labels that do not fit side by side.
inline constexpr int kSlant_deg = 30;
/// Length of the mark in a legend, and from its beginning to the text [px].
inline constexpr double kSample_px = 24.0;
inline constexpr double kSampleToText_px = 30.0;

}  // namespace stillhand::report
