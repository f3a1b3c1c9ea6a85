// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace stillhand::report {

/// Adapts gnuplot's SVG, so that several can stand on one page:
///
/// - every id, and every reference to one, begins with `prefix`-: gnuplot gives each picture the
///   same ids;
/// - there is one font for all texts, with alternatives for other systems;
/// - tool tips ("gnuplot_plot_1") and empty groups are removed.
///
/// Texts between tags stay as they are.  Pure.
/// @param prefix  letters, digits, '-' and '_'
std::string adapted_svg(std::string_view svg, std::string_view prefix);

/// The SVG without its XML declaration, for use inside HTML.  `label` describes the picture to
/// screen readers, and `--width` gives its width to the style sheet.
std::string inline_svg(std::string_view svg, std::string_view label, int width_px);

}  // namespace stillhand::report
