// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

/// The numbers of a figure as CSV, one row a value, in the order of drawing:
///
///   panel,x_axis,y_axis,series,x,x_label,y,y_low,y_high
///
/// `panel` counts from 1; the axes' labels hold the units.  x_label is the category at x, where the
/// axis has categories.  A cell is empty where the kind of series has no such number, or the number
/// is not finite.  A box is one row a number, and the series' name says which.  Unlike the picture,
/// the table is not thinned.  Pure.
std::string figure_table(const Figure& figure);

/// The files of a figure: NAME.svg, NAME.png, NAME.csv.
std::vector<std::string> figure_files(const std::string& name);

}  // namespace stillhand::report
