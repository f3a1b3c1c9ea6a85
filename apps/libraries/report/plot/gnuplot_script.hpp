// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

/// gnuplot's commands for one figure, split so that the numbers are sent once and drawn on two
/// terminals.  Of the caller's input they contain only numbers and quoted strings.
struct FigureScript {
  std::string data;  ///< named data blocks
  std::string body;  ///< one plot command a panel, for use inside `set multiplot`
};

/// The same figure gives the same text.  Pure.
/// Aborts on a figure without size, panels or a valid name, and on arrays of unequal length.
FigureScript script_of(const Figure& figure);

}  // namespace stillhand::report
