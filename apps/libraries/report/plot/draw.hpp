// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

/// A figure as drawn: Page takes the SVG in.
struct Drawing {
  std::string name;
  std::string caption;
  int width_px = 0;
  std::string svg;  ///< a whole document; its ids begin with the figure's name
  std::string png;  ///< twice the figure's pixels, on white
};

/// Starts gnuplot and lets it end, to check that it is installed before the work.
/// @throws as draw()
void require_gnuplot();

/// Draws figures with gnuplot, in two processes at the same time when there are two or more.
/// The same figures give the same bytes.  Names must differ.
/// @throws ConfigError         when gnuplot is not installed
/// @throws std::runtime_error  when gnuplot fails, with its message
std::vector<Drawing> draw(std::span<const Figure> figures);

/// As draw(), and writes figure_files() of each figure in `folder`, which exists.  Each file
/// appears whole or not at all.
/// @throws also std::runtime_error when a file cannot be written, with the file and the reason
std::vector<Drawing> render(std::span<const Figure> figures, const std::filesystem::path& folder);

}  // namespace stillhand::report
