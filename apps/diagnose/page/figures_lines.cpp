// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::diagnose {
namespace {

using report::Colour;
using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

void add_points(Panel& panel, const char* label, const diagnosis::LineGroup& group, Colour colour) {
  if (group.empty()) return;
  panel.series.push_back({.label = label,
                          .kind = Kind::kPoints,
                          .colour = colour,
                          .x = group.frequency_hz,
                          .y = group.residual,
                          .point_size = 0.7});
}

// Of all groups as one line, from the lowest frequency to the highest.
void add_noise(Panel& panel, const std::vector<const diagnosis::LineGroup*>& groups) {
  std::map<double, double> noise;
  for (const diagnosis::LineGroup* group : groups) {
    for (std::size_t i = 0; i < group->frequency_hz.size(); ++i) {
      noise[group->frequency_hz[i]] = group->noise[i];
    }
  }
  if (noise.empty()) return;
  Series series{.label = "noise at the lines",
                .kind = Kind::kDottedLine,
                .colour = Colour::kNeutral,
                .line_width_px = 1.4};
  for (const auto& [frequency_hz, level] : noise) {
    series.x.push_back(frequency_hz);
    series.y.push_back(level);
  }
  panel.series.push_back(std::move(series));
}

Panel panel_of(const diagnosis::DetectionLines& lines, const std::string& title,
               const std::string& unit) {
  Panel panel;
  panel.title = title;
  panel.x = {.label = "frequency [Hz]", .scale = Scale::kLogarithmic};
  panel.y = {.label = axis_label("RMS of a line", unit), .scale = Scale::kLogarithmic};
  add_noise(panel, {&lines.odd, &lines.even, &lines.odd_or_even});
  panel.series.push_back({.label = "output, excited",
                          .kind = Kind::kPoints,
                          .colour = Colour::kNeutral,
                          .x = lines.excited.frequency_hz,
                          .y = lines.excited.output,
                          .point_size = 0.7});
  add_points(panel, "residual, excited", lines.excited, Colour::kMeasured);
  add_points(panel, "odd, not excited", lines.odd, Colour::kWarning);
  add_points(panel, "even", lines.even, Colour::kAccent);
  add_points(panel, "not excited", lines.odd_or_even, Colour::kWarning);
  return panel;
}

std::string chances(const diagnosis::DetectionLines& lines) {
  std::string text;
  const auto add = [&text](const char* name, const diagnosis::LineGroup& group) {
    if (group.empty()) return;
    text += (text.empty() ? "" : "; ") + std::string(name) + " " + percent(group.share, 1) +
            " (p " + p_value(group.p) + ")";
  };
  add("odd lines", lines.odd);
  add("even lines", lines.even);
  add("lines not excited", lines.odd_or_even);
  return text.empty() ? "every line is excited" : text;
}

}  // namespace

report::Figure figure_lines(const Evidence& evidence) {
  const diagnosis::Diagnosis& found = evidence.found;
  const diagnosis::DetectionLines& before = *found.before.lines;
  std::vector<Panel> panels{panel_of(before, "baseline's residual", found.output_unit)};
  std::string groups =
      "Share of the residual's power above the noise, before: " + chances(before) + ".";
  if (!found.effects.empty() && found.after.lines) {
    panels.push_back(panel_of(*found.after.lines, "residual with the effects", found.output_unit));
    groups += " After: " + chances(*found.after.lines) + ".";
  }
  const int columns = static_cast<int>(panels.size());
  return {.name = "detection_lines",
          .caption = "The excitation repeats every " +
                     report::short_number(static_cast<double>(before.periodicity.period) /
                                          found.sample_rate_hz) +
                     " s, " + std::to_string(before.repeats.periods) + " periods: harmonics of " +
                     report::short_number(before.fundamental_hz) +
                     " Hz. A linear system responds at the excited harmonics alone. Distortion of "
                     "even order appears at even harmonics, distortion of odd order at odd ones. "
                     "Dotted: the noise at each harmonic, from the lines between the harmonics. " +
                     groups + " p is not corrected here; the table of questions corrects it.",
          .panels = std::move(panels),
          .columns = columns,
          .width_px = 980,
          .height_px = 400};
}

}  // namespace stillhand::diagnose
