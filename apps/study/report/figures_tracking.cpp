// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/study/report/figures.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::study {
namespace {

using report::Colour;
using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

constexpr double kExcerptRate_hz = 20.0;
constexpr std::size_t kFittedLines = 11;  // paper III-C
constexpr double kHighestPhase_deg = 90.0;

Panel trace_panel(const TrackedTrial& trial, Condition condition) {
  Panel panel;
  panel.title = title_of(condition);
  panel.x.label = "time [s]";
  panel.y.label = "position on the screen [mm]";
  Series target{.label = "target", .kind = Kind::kLine, .colour = Colour::kTarget};
  Series cursor{.label = "cursor", .kind = Kind::kDashedLine, .colour = colour_of(condition)};
  for (std::size_t i = 0; i < trial.target_m.size(); ++i) {
    target.x.push_back(static_cast<double>(i) / kExcerptRate_hz);
    target.y.push_back(kMmPerM * trial.target_m[i]);
    cursor.y.push_back(kMmPerM * trial.cursor_m[i]);
  }
  cursor.x = target.x;
  target.line_width_px = 1.3;
  panel.series = {target, cursor};
  return panel;
}

// Mean over subjects with one standard deviation on either side, against the start of the window.
Panel moving_panel(const StudyRecord& record, Condition condition,
                   const std::vector<double>& (*series_of)(const TrackedTrial&)) {
  Panel panel;
  panel.title = title_of(condition);
  panel.x.label = "start of the 10 s window [s]";
  panel.legend = report::Legend::kNone;
  Series band{.kind = Kind::kBand, .colour = colour_of(condition)};
  Series mean{.kind = Kind::kLine, .colour = colour_of(condition)};
  const std::size_t seconds = series_of(record.results.front().trials.at(condition)).size();
  for (std::size_t s = 0; s < seconds; ++s) {
    std::vector<double> values;
    for (const SubjectResult& result : record.results) {
      values.push_back(series_of(result.trials.at(condition))[s]);
    }
    const MetricSample at = summarised(values);
    const double deviation = at.standard_deviation.value_or(0.0);
    mean.x.push_back(static_cast<double>(s));
    mean.y.push_back(at.mean);
    band.y_low.push_back(at.mean - deviation);
    band.y_high.push_back(at.mean + deviation);
  }
  band.x = mean.x;
  mean.line_width_px = 2.4;
  panel.series = {band, mean};
  return panel;
}

report::Figure moving_figure(const StudyRecord& record, const char* name, const char* quantity,
                             const char* number,
                             const std::vector<double>& (*series_of)(const TrackedTrial&)) {
  report::Figure figure{.name = name,
                        .caption = fmt::format(
                            "The paper's {}: {} over a moving window of 10 s, mean of the subjects "
                            "with one standard deviation on either side.",
                            number, quantity),
                        .panels = {},
                        .columns = 3,
                        .width_px = 1180,
                        .height_px = 330};
  double highest = 0.0;
  for (const Condition condition : conditions_run(record, kFigureConditions)) {
    figure.panels.push_back(moving_panel(record, condition, series_of));
    for (const double y : figure.panels.back().series.front().y_high) {
      highest = std::max(highest, y);
    }
  }
  for (Panel& panel : figure.panels) {  // the same scale for all conditions
    panel.y.low = 0.0;
    panel.y.high = 1.08 * highest;
  }
  const std::size_t rows = (figure.panels.size() + 2) / 3;
  figure.height_px = static_cast<int>(330 * std::max<std::size_t>(1, rows));
  if (!figure.panels.empty()) figure.panels.front().y.label = quantity;
  return figure;
}

void add_open_loop(Panel& magnitude, Panel& phase, const identification::TrackingMetrics& metrics,
                   Condition condition) {
  Series points{.label = "X_p/X_e", .kind = Kind::kPoints, .colour = colour_of(condition)};
  Series line{.label = "−20 dB/decade", .kind = Kind::kLine, .colour = Colour::kModel};
  Series angle = points;
  for (std::size_t k = 0; k < metrics.lines.size(); ++k) {
    const auto& at = metrics.lines[k];
    points.x.push_back(at.frequency_hz);
    points.y.push_back(20.0 * std::log10(std::abs(at.gain)));
    angle.y.push_back(phase_up_to_deg(at.gain, kHighestPhase_deg));
    if (k >= kFittedLines) continue;
    line.x.push_back(at.frequency_hz);
    line.y.push_back(20.0 * std::log10(metrics.crossover_hz / at.frequency_hz));
  }
  angle.x = points.x;
  angle.show_in_legend = false;
  magnitude.series = {line, points};
  phase.series = {angle};
}

}  // namespace

report::Figure traces_figure(const std::map<Condition, const TrackedTrial*>& trials,
                             const std::string& name, const std::string& caption) {
  report::Figure figure{.name = name,
                        .caption = caption,
                        .panels = {},
                        .columns = 1,
                        .width_px = 980,
                        .height_px = static_cast<int>(260 * trials.size())};
  double farthest_mm = 0.0;
  for (const auto& [condition, trial] : trials) {
    figure.panels.push_back(trace_panel(*trial, condition));
    for (const Series& series : figure.panels.back().series) {
      for (const double y : series.y) farthest_mm = std::max(farthest_mm, std::abs(y));
    }
  }
  for (Panel& panel : figure.panels) {  // the same scale for all conditions
    panel.y.low = -1.05 * farthest_mm;
    panel.y.high = 1.05 * farthest_mm;
  }
  return figure;
}

report::Figure figure_traces(const StudyRecord& record) {
  const std::size_t typical = typical_subject(record);
  std::map<Condition, const TrackedTrial*> trials;
  for (const Condition condition : conditions_run(record, kFigureConditions)) {
    trials[condition] = &record.results[typical].trials.at(condition);
  }
  report::Figure figure = traces_figure(
      trials, "fig07_traces",
      fmt::format("The paper's Fig. 7: up to twenty seconds from the middle of the trials of {}{}.",
                  subject_name(record, typical),
                  record.recorded ? "; of several trials of a condition, the last" : ""));
  figure.height_px = std::max(figure.height_px, 780);
  return figure;
}

report::Figure figure_moving_rms(const StudyRecord& record) {
  return moving_figure(record, "fig08_moving_rms", "RMS error [mm]", "Fig. 8",
                       [](const TrackedTrial& trial) -> const std::vector<double>& {
                         return trial.metrics.moving_rms_mm;
                       });
}

report::Figure figure_moving_dwell(const StudyRecord& record) {
  return moving_figure(record, "fig09_moving_dwell", "dwell ratio [-]", "Fig. 9",
                       [](const TrackedTrial& trial) -> const std::vector<double>& {
                         return trial.metrics.moving_dwell;
                       });
}

report::Figure figure_open_loop(const StudyRecord& record) {
  const std::size_t typical = typical_subject(record);
  report::Figure figure{
      .name = "fig12_open_loop",
      .caption = fmt::format(
          "The paper's Fig. 12: open loop X_p/X_e of {} at the fifteen frequencies of the "
          "target, with a line of −20 dB/decade fitted to the lowest eleven. The line crosses 0 dB "
          "at the crossover frequency.",
          subject_name(record, typical)),
      .panels = {},
      .columns = 3,
      .width_px = 1180,
      .height_px = 560};
  std::vector<Panel> phases;
  for (const Condition condition : conditions_run(record, kFigureConditions)) {
    Panel magnitude;
    Panel phase;
    const auto& metrics = record.results[typical].trials.at(condition).metrics;
    add_open_loop(magnitude, phase, metrics, condition);
    magnitude.notes = {{.text = fmt::format("f_c = {:.2f} Hz", metrics.crossover_hz),
                        .corner = report::Corner::kTopRight}};
    magnitude.title = title_of(condition);
    magnitude.x = phase.x = {.label = "", .scale = Scale::kLogarithmic, .low = 0.008, .high = 6.0};
    phase.x.label = "frequency [Hz]";
    magnitude.y = {.label = phases.empty() ? "|X_p/X_e| [dB]" : "", .low = -45.0, .high = 35.0};
    phase.y = {.label = phases.empty() ? "phase [°]" : "",
               .scale = Scale::kDegrees,
               .low = kHighestPhase_deg - 360.0,
               .high = kHighestPhase_deg};
    magnitude.reference_lines = {{.at = 0.0, .label = {}, .colour = Colour::kNeutral}};
    magnitude.legend = phase.legend = report::Legend::kNone;
    figure.panels.push_back(magnitude);
    phases.push_back(phase);
  }
  figure.columns = static_cast<int>(phases.size());
  figure.panels.insert(figure.panels.end(), phases.begin(), phases.end());
  return figure;
}

}  // namespace stillhand::study
