// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stillhand::report {

/// gnuplot's SVG made fit to stand beside others on one page:
///
/// - every id, and every reference to one, begins with `prefix`-: gnuplot gives each picture the
///   same ids;
/// - one font for all, with what other systems have instead;
/// - tool tips ("gnuplot_plot_1") and empty groups are gone.
///
/// Texts between tags stay as they are.  Pure.
/// @param prefix  letters, digits, '-' and '_'
std::string adapted_svg(std::string_view svg, std::string_view prefix);

/// The same without its XML declaration, for use inside HTML: `label` tells readers who do not see
/// it what it shows, and the style sheet learns its size as `--width`.
std::string inline_svg(std::string_view svg, std::string_view label, int width_px);

}  // namespace stillhand::report
