// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "apps/libraries/report/plot/panel_layout.hpp"

namespace stillhand::report {

/// Data block and plot clauses of one series; no clauses if it has nothing to draw.
struct SeriesScript {
  std::string data;
  std::vector<std::string> clauses;
};

/// @param block   name of the data block, for example "$p0s1"
/// Long lines and clouds are thinned (thinning.hpp); a gap is an empty line of the block.  Pure.
SeriesScript series_script(const Series& series, const PanelLayout& layout,
                           const std::string& block);

/// gnuplot's line style of a series: colour, width, dashes.
std::string line_style(const Series& series);
/// gnuplot's point style of a series: shape and size.
std::string point_style(const Series& series);
/// Colour of a series that has only points.  A line's style contains the colour already, and
/// gnuplot accepts it only once.
std::string colour_style(const Series& series);

/// Share of the colour in the area of a band, bar or box [-].
double fill_density(Kind kind);

}  // namespace stillhand::report
