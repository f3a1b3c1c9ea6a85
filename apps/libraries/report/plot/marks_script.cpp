// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/marks_script.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "apps/libraries/report/plot/palette.hpp"
#include "apps/libraries/report/plot/series_script.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {

constexpr double kNoteRow_px = 17.0;
constexpr double kLabelRow_px = 15.0;

std::string rectangle_command(const Canvas& canvas, const Rectangle& box,
                              const std::string& style) {
  return "set object rectangle from " + canvas.at(box.left, box.bottom) + " to " +
         canvas.at(box.right, box.top) + " front " + style + "\n";
}

std::string stroke_command(const Canvas& canvas, double x0_px, double y0_px, double x1_px,
                           double y1_px, const std::string& style) {
  return "set arrow from " + canvas.at(x0_px, y0_px) + " to " + canvas.at(x1_px, y1_px) +
         " nohead " + style + "\n";
}

// Veils what is behind a text.
std::string backing(const Canvas& canvas, const Rectangle& box) {
  return rectangle_command(canvas, {box.left - 2.0, box.top, box.right + 2.0, box.bottom},
                           "fillcolor rgb 'white' fillstyle transparent solid 0.8 noborder");
}

bool shows_point(Kind kind) {
  return kind == Kind::kPoints || kind == Kind::kLineAndPoints || kind == Kind::kErrorBars;
}

bool shows_area(Kind kind) {
  return kind == Kind::kBand || kind == Kind::kBars || kind == Kind::kBox;
}

// The mark before a legend's text, as the data are drawn.
std::string sample(const Series& series, const LegendEntry& entry, const Canvas& canvas) {
  const double left_px = entry.left_px;
  const double middle_px = entry.middle_px;
  const double centre_px = left_px + 0.5 * kSample_px;
  std::string script;
  if (shows_area(series.kind)) {
    const std::string rgb = "rgb '" + std::string(look(series.colour).rgb) + "'";
    const bool border = series.kind != Kind::kBand;
    const Rectangle box{left_px + (border ? 5.0 : 0.0), middle_px - 5.0,
                        left_px + kSample_px - (border ? 5.0 : 0.0), middle_px + 5.0};
    return rectangle_command(canvas, box,
                             "fillcolor " + rgb + " fillstyle transparent solid " +
                                 decimal(fill_density(series.kind)) +
                                 (border ? " border lc " + rgb : std::string(" noborder")));
  }
  if (series.kind == Kind::kErrorBars) {
    script += stroke_command(canvas, centre_px, middle_px - 7.0, centre_px, middle_px + 7.0,
                             "front" + line_style(series));
  } else if (series.kind != Kind::kPoints) {
    script += stroke_command(canvas, left_px, middle_px, left_px + kSample_px, middle_px,
                             "front" + line_style(series));
  }
  if (shows_point(series.kind)) {
    script += "set label '' at " + canvas.at(centre_px, middle_px) + " front point" +
              point_style(series) + colour_style(series) + "\n";
  }
  return script;
}

double x_of(const PanelLayout& layout, double value) {
  return layout.plot.left + layout.x.fraction(value) * layout.plot.width();
}

double y_of(const PanelLayout& layout, double value) {
  return layout.plot.bottom - layout.y.fraction(value) * layout.plot.height();
}

bool within(const AxisLayout& axis, double value) {
  return axis.drawable(value) && value >= axis.low && value <= axis.high;
}

// A horizontal line's label above its right end; at the left one when it would cover another.
class ReferenceLabels {
 public:
  ReferenceLabels(const PanelLayout& layout, const Canvas& canvas)
      : layout_(layout), canvas_(canvas) {
    if (layout.legend.height() > 0.0) taken_.push_back(layout.legend);
  }

  std::string horizontal(const ReferenceLine& line, double y_px) {
    const Rectangle& plot = layout_.plot;
    const double width_px = text_width_px(line.label, kSmallFontSize_px);
    const double above_px = y_px - 8.0;
    const double middle_px = above_px - 6.0 < plot.top ? y_px + 8.0 : above_px;
    Rectangle box{plot.right - 5.0 - width_px, middle_px - 7.0, plot.right - 5.0, middle_px + 7.0};
    if (collides(box)) {
      box.left = plot.left + 5.0;
      box.right = box.left + width_px;
    }
    return put(line, box);
  }

  std::string vertical(const ReferenceLine& line, double x_px) {
    const Rectangle& plot = layout_.plot;
    const double width_px = text_width_px(line.label, kSmallFontSize_px);
    const bool left = x_px + 5.0 + width_px > plot.right;
    Rectangle box{left ? x_px - 5.0 - width_px : x_px + 5.0, plot.top + 3.0, 0.0, plot.top + 17.0};
    box.right = box.left + width_px;
    while (collides(box) && box.bottom + kLabelRow_px < plot.bottom) {
      box.top += kLabelRow_px;
      box.bottom += kLabelRow_px;
    }
    return put(line, box);
  }

 private:
  bool collides(const Rectangle& box) const {
    return std::any_of(taken_.begin(), taken_.end(), [&](const Rectangle& other) {
      return box.left < other.right && other.left < box.right && box.top < other.bottom &&
             other.top < box.bottom;
    });
  }

  std::string put(const ReferenceLine& line, Rectangle box) {
    // gnuplot leaves out a text that begins outside the picture.
    box.left = std::max(box.left, layout_.plot.left + 2.0);
    taken_.push_back(box);
    const Lettering small{Anchor::kLeft, kSmallFontSize_px, false, 0,
                          std::string(look(line.colour).rgb)};
    return backing(canvas_, box) +
           text_command(canvas_, line.label, box.left, 0.5 * (box.top + box.bottom), small);
  }

  const PanelLayout& layout_;
  const Canvas& canvas_;
  std::vector<Rectangle> taken_;
};

// Rows of notes in the corners; in each the first note is the topmost.
class NoteRows {
 public:
  NoteRows(const Panel& panel, const PanelLayout& layout) {
    next_px_ = {layout.plot.top + 6.0, layout.plot.top + 6.0, layout.plot.bottom - 6.0,
                layout.plot.bottom - 6.0};
    if (layout.legend.height() > 0.0) {
      const auto corner = static_cast<std::size_t>(layout.legend_place) - 1;  // Corner's order
      const double used_px = layout.legend.height() + 4.0;
      next_px_.at(corner) += corner < kFirstBottom ? used_px : -used_px;
    }
    for (const Note& note : panel.notes) {
      const auto corner = static_cast<std::size_t>(note.corner);
      if (!note.at && corner >= kFirstBottom) next_px_.at(corner) -= kNoteRow_px;
    }
  }

  /// Middle of the next row, from the top of the picture.
  double next_px(Corner corner) {
    double& next = next_px_.at(static_cast<std::size_t>(corner));
    next += kNoteRow_px;
    return next - 0.5 * kNoteRow_px;
  }

 private:
  static constexpr std::size_t kFirstBottom = static_cast<std::size_t>(Corner::kBottomLeft);
  std::array<double, 4> next_px_{};
};

}  // namespace

std::string Canvas::at(double x_px, double y_px) const {
  return "screen " + decimal(x_px / width_px) + ",screen " + decimal(1.0 - y_px / height_px);
}

std::string text_command(const Canvas& canvas, const std::string& text, double x_px, double y_px,
                         const Lettering& lettering) {
  static constexpr std::array<std::string_view, 3> kAnchors = {" left", " centre", " right"};
  std::string command = "set label " + gnuplot_quoted(text) + " at " + canvas.at(x_px, y_px) +
                        std::string(kAnchors.at(static_cast<std::size_t>(lettering.anchor)));
  if (lettering.rotation_deg != 0) {
    command += " rotate by " + std::to_string(lettering.rotation_deg);
  }
  command += std::string(" front noenhanced font 'DejaVu Sans") + (lettering.bold ? ":Bold" : "") +
             "," + decimal(lettering.size_px) + "'";
  const std::string rgb = lettering.rgb.empty() ? std::string(kTextRgb) : lettering.rgb;
  return command + " textcolor rgb '" + rgb + "'\n";
}

std::string legend_script(const Panel& panel, const PanelLayout& layout, const Canvas& canvas) {
  std::string script;
  if (layout.legend.width() > 0.0) script += backing(canvas, layout.legend);
  for (const LegendEntry& entry : layout.entries) {
    const Series& series = panel.series[entry.series];
    script += sample(series, entry, canvas);
    script +=
        text_command(canvas, series.label, entry.left_px + kSampleToText_px, entry.middle_px, {});
  }
  return script;
}

std::string reference_line_script(const Panel& panel, const PanelLayout& layout,
                                  const Canvas& canvas) {
  const Rectangle& plot = layout.plot;
  ReferenceLabels labels(layout, canvas);
  std::string script;
  for (const ReferenceLine& line : panel.reference_lines) {
    const bool horizontal = line.direction == Direction::kHorizontal;
    if (!within(horizontal ? layout.y : layout.x, line.at)) continue;
    const std::string style =
        "front lw 1.2 dt (5,4) lc rgb '" + std::string(look(line.colour).rgb) + "'";
    const double at_px = horizontal ? y_of(layout, line.at) : x_of(layout, line.at);
    script += horizontal ? stroke_command(canvas, plot.left, at_px, plot.right, at_px, style)
                         : stroke_command(canvas, at_px, plot.bottom, at_px, plot.top, style);
    if (line.label.empty()) continue;
    script += horizontal ? labels.horizontal(line, at_px) : labels.vertical(line, at_px);
  }
  return script;
}

std::string note_script(const Panel& panel, const PanelLayout& layout, const Canvas& canvas) {
  std::string script;
  NoteRows rows(panel, layout);
  for (const Note& note : panel.notes) {
    const double width_px = text_width_px(note.text, kSmallFontSize_px);
    Rectangle box;
    bool right = false;
    if (note.at) {
      const auto [x, y] = *note.at;
      if (!within(layout.x, x) || !within(layout.y, y)) continue;
      const double x_px = x_of(layout, x);
      right = x_px + 8.0 + width_px > layout.plot.right;
      box.left = right ? x_px - 8.0 - width_px : x_px + 8.0;
      box.top = y_of(layout, y) - 8.0;
    } else {
      right = note.corner == Corner::kTopRight || note.corner == Corner::kBottomRight;
      box.left = right ? layout.plot.right - 10.0 - width_px : layout.plot.left + 10.0;
      box.top = rows.next_px(note.corner) - 8.0;
    }
    box.right = box.left + width_px;
    box.bottom = box.top + 16.0;
    script += backing(canvas, box);
    script += text_command(canvas, note.text, right ? box.right : box.left, box.top + 8.0,
                           {right ? Anchor::kRight : Anchor::kLeft, kSmallFontSize_px});
  }
  return script;
}

}  // namespace stillhand::report
