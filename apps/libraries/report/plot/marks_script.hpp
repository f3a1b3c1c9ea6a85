// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "apps/libraries/report/plot/figure.hpp"
#include "apps/libraries/report/plot/panel_layout.hpp"

namespace stillhand::report {

/// Size of the picture, to turn pixels into gnuplot's screen coordinates.
struct Canvas {
  double width_px = 0.0;
  double height_px = 0.0;

  /// "screen x, screen y" of a point counted from the top left corner.
  [[nodiscard]] std::string at(double x_px, double y_px) const;
};

/// Position of the given point in a text.
enum class Anchor { kLeft, kCentre, kRight };

struct Lettering {
  Anchor anchor = Anchor::kLeft;
  double size_px = kFontSize_px;
  bool bold = false;
  int rotation_deg = 0;  ///< counterclockwise; 90 reads from bottom to top
  std::string rgb = {};  ///< empty: the usual text colour
};

/// Command that writes a text with its vertical middle at y_px.
std::string text_command(const Canvas& canvas, const std::string& text, double x_px, double y_px,
                         const Lettering& lettering);

/// Commands for the other parts of a panel: legend, reference lines, notes.  Pure.
std::string legend_script(const Panel& panel, const PanelLayout& layout, const Canvas& canvas);
std::string reference_line_script(const Panel& panel, const PanelLayout& layout,
                                  const Canvas& canvas);
std::string note_script(const Panel& panel, const PanelLayout& layout, const Canvas& canvas);

}  // namespace stillhand::report
