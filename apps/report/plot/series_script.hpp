// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/report/plot/figure.hpp"
#include "apps/report/plot/panel_layout.hpp"

namespace stillhand::report {

/// Data block and plot clauses of one series; no clauses when it holds nothing to draw.
struct SeriesScript {
  std::string data;
  std::vector<std::string> clauses;
};

/// @param block   name of the data block, for example "$p0s1"
/// Long lines and clouds are thinned (thinning.hpp); a gap is an empty line of the block.  Pure.
SeriesScript series_script(const Series& series, const PanelLayout& layout,
                           const std::string& block);

/// gnuplot's words for how the line of a kind is drawn: colour, width, dashes.
std::string line_style(const Series& series);
/// The same for its points: shape and size.
std::string point_style(const Series& series);
/// Colour of a kind that has points alone; a line's style holds it already, and gnuplot takes a
/// colour once.
std::string colour_style(const Series& series);

/// How much of the colour the area of a band, bar or box takes [-].
double fill_density(Kind kind);

}  // namespace stillhand::report
