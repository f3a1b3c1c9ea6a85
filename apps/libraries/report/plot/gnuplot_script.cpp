// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/gnuplot_script.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "apps/libraries/report/plot/marks_script.hpp"
#include "apps/libraries/report/plot/palette.hpp"
#include "apps/libraries/report/plot/panel_layout.hpp"
#include "apps/libraries/report/plot/series_script.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::report {
namespace {

bool good_name(const std::string& name) {
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  return !name.empty() && name.find_first_not_of(kAllowed) == std::string::npos;
}

std::string rgb(std::string_view colour) { return "rgb '" + std::string(colour) + "'"; }

std::string margin_commands(const Rectangle& plot, const Canvas& canvas) {
  return "set lmargin at screen " + decimal(plot.left / canvas.width_px) +
         "\nset rmargin at screen " + decimal(plot.right / canvas.width_px) +
         "\nset tmargin at screen " + decimal(1.0 - plot.top / canvas.height_px) +
         "\nset bmargin at screen " + decimal(1.0 - plot.bottom / canvas.height_px) + "\n";
}

// Ticks without labels: where gnuplot puts those differs between its terminals.
std::string axis_commands(const AxisLayout& axis, const std::string& letter) {
  std::string script;
  if (axis.logarithmic) script += "set logscale " + letter + "\n";
  script += "set " + letter + "range [" + decimal(axis.low) + ":" + decimal(axis.high) + "]\n";
  script += "set " + letter + "tics out nomirror scale ";
  script += axis.categories ? "0 (" : "0.5,0.25 (";
  // gnuplot's grammar wants one at least; this one is out of sight.
  script += "'' " + decimal(axis.high + 2.0 * (axis.high - axis.low));
  for (const AxisTick& tick : axis.major) script += ",'' " + decimal(tick.at);
  for (const double at : axis.minor) script += ",'' " + decimal(at) + " 1";
  return script + ")\n";
}

std::string tick_label_commands(const PanelLayout& layout, const Canvas& canvas) {
  const Rectangle& plot = layout.plot;
  std::string script;
  for (const AxisTick& tick : layout.x.major) {
    const double x_px = plot.left + layout.x.fraction(tick.at) * plot.width();
    script += layout.slanted_x_labels
                  ? text_command(canvas, tick.label, x_px + 3.0, plot.bottom + 10.0,
                                 {Anchor::kRight, kFontSize_px, false, kSlant_deg})
                  : text_command(canvas, tick.label, x_px, plot.bottom + 15.0, {Anchor::kCentre});
  }
  for (const AxisTick& tick : layout.y.major) {
    const double y_px = plot.bottom - layout.y.fraction(tick.at) * plot.height();
    script += text_command(canvas, tick.label, plot.left - kTickToLabel_px, y_px, {Anchor::kRight});
  }
  return script;
}

std::string frame_commands(const PanelLayout& layout) {
  std::string script = "set border 3 lw 1 lc " + rgb(kFrameRgb) + "\n";
  script += "set grid" + std::string(layout.x.categories ? "" : " xtics mxtics") +
            (layout.y.categories ? "" : " ytics mytics") + " back lt 1 dt solid lw 0.9 lc " +
            rgb(kGridRgb) + ", lt 1 dt solid lw 0.7 lc " + rgb(kMinorGridRgb) + "\n";
  script += axis_commands(layout.x, "x");
  script += axis_commands(layout.y, "y");
  return script + "unset key\nset clip two\n";
}

std::string lettering_commands(const Panel& panel, const PanelLayout& layout,
                               const Canvas& canvas) {
  const Rectangle& plot = layout.plot;
  std::string script = tick_label_commands(layout, canvas);
  if (!panel.title.empty()) {
    script += text_command(canvas, panel.title, plot.left, layout.title_px,
                           {Anchor::kLeft, kFontSize_px, true});
  }
  if (!panel.x.label.empty()) {
    script += text_command(canvas, panel.x.label, 0.5 * (plot.left + plot.right), layout.x_label_px,
                           {Anchor::kCentre});
  }
  if (!panel.y.label.empty()) {
    script += text_command(canvas, panel.y.label, layout.y_label_px, 0.5 * (plot.top + plot.bottom),
                           {Anchor::kCentre, kFontSize_px, false, 90});
  }
  return script;
}

void add_panel(FigureScript& script, const Panel& panel, const PanelLayout& layout,
               const Canvas& canvas, const std::string& block) {
  if (panel.blank) return;
  std::string clauses;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const SeriesScript series =
        series_script(panel.series[i], layout, block + "s" + std::to_string(i));
    script.data += series.data;
    for (const std::string& clause : series.clauses) {
      clauses += (clauses.empty() ? "" : ", ") + clause + " notitle";
    }
  }
  script.body += "reset\n" + margin_commands(layout.plot, canvas) + frame_commands(layout);
  script.body += lettering_commands(panel, layout, canvas);
  script.body += reference_line_script(panel, layout, canvas);
  script.body += legend_script(panel, layout, canvas) + note_script(panel, layout, canvas);
  if (clauses.empty()) {
    script.body += text_command(
        canvas, "no data", 0.5 * (layout.plot.left + layout.plot.right),
        0.5 * (layout.plot.top + layout.plot.bottom),
        {Anchor::kCentre, kFontSize_px, false, 0, std::string(look(Colour::kNeutral).rgb)});
    clauses = "NaN notitle";
  }
  script.body += "plot " + clauses + "\n";
}

}  // namespace

FigureScript script_of(const Figure& figure) {
  STILLHAND_EXPECTS(good_name(figure.name));
  STILLHAND_EXPECTS(figure.width_px > 0 && figure.height_px > 0 && figure.columns > 0);
  STILLHAND_EXPECTS(!figure.panels.empty());
  const Canvas canvas{static_cast<double>(figure.width_px), static_cast<double>(figure.height_px)};
  const std::vector<PanelLayout> layouts = lay_out(figure);
  FigureScript script;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    add_panel(script, figure.panels[i], layouts[i], canvas, "$p" + std::to_string(i));
  }
  return script;
}

}  // namespace stillhand::report
