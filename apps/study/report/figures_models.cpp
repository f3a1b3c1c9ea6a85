// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "apps/study/report/figures.hpp"

namespace stillhand::study {
namespace {

using report::Colour;
using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

// The paper's Bode plots end near the filter's 10 Hz; the plots here go slightly further.
constexpr double kLowest_hz = 0.2;
constexpr double kHighest_hz = 15.0;
constexpr int kPoints = 160;
constexpr std::size_t kMostSmallPlots = 12;

double decibels(std::complex<double> h) { return 20.0 * std::log10(std::abs(h)); }

// The response starts and ends at -180 degrees: phases from -360 to 0 need no unwrapping.
double phase_deg(std::complex<double> h) { return phase_up_to_deg(h, 0.0); }

std::vector<double> bode_grid_hz() {
  std::vector<double> out;
  for (int i = 0; i <= kPoints; ++i) {
    out.push_back(kLowest_hz *
                  std::pow(kHighest_hz / kLowest_hz, static_cast<double>(i) / kPoints));
  }
  return out;
}

Series curve(const signal::DifferenceModel& model, double (*of)(std::complex<double>)) {
  Series out;
  out.x = bode_grid_hz();
  for (const double f : out.x) out.y.push_back(of(signal::response_at(model, f)));
  return out;
}

Panel bode_panel(const char* title, const char* unit, Scale scale) {
  Panel panel;
  panel.title = title;
  panel.x = {.label = "frequency [Hz]",
             .scale = Scale::kLogarithmic,
             .low = kLowest_hz,
             .high = kHighest_hz};
  panel.y = {.label = unit, .scale = scale};
  return panel;
}

void add_estimate(Panel& magnitude, Panel& phase, Panel& coherence,
                  const signal::TransferEstimate& estimate) {
  Series band{.label = "95 % band", .kind = Kind::kBand, .colour = Colour::kMeasured};
  Series dots{.label = "spectral estimate", .kind = Kind::kPoints, .colour = Colour::kMeasured};
  dots.point_size = 0.6;
  Series angle = dots;
  Series g2{.label = "coherence", .kind = Kind::kLine, .colour = Colour::kMeasured};
  for (std::size_t i = 0; i < estimate.frequency_hz.size(); ++i) {
    const double f = estimate.frequency_hz[i];
    if (f < kLowest_hz || f > kHighest_hz) continue;
    const double size = std::abs(estimate.response[i]);
    const double half = estimate.magnitude_ci95[i] * size;
    dots.x.push_back(f);
    dots.y.push_back(decibels(estimate.response[i]));
    band.x.push_back(f);
    band.y_high.push_back(20.0 * std::log10(size + half));
    // An interval that reaches zero has no lower end in decibels; the band then ends 20 dB below.
    band.y_low.push_back(20.0 * std::log10(std::max(size - half, 0.1 * size)));
    angle.x.push_back(f);
    angle.y.push_back(phase_deg(estimate.response[i]));
    g2.x.push_back(f);
    g2.y.push_back(estimate.coherence[i]);
  }
  angle.show_in_legend = false;
  g2.show_in_legend = false;
  magnitude.series = {band, dots};
  phase.series = {angle};
  coherence.series = {g2};
}

void add_model(Panel& magnitude, Panel& phase, const signal::DifferenceModel& model,
               const std::string& label, Colour colour, Kind kind) {
  Series size = curve(model, decibels);
  Series angle = curve(model, phase_deg);
  size.label = angle.label = label;
  size.colour = angle.colour = colour;
  size.kind = angle.kind = kind;
  angle.show_in_legend = false;
  magnitude.series.push_back(size);
  phase.series.push_back(angle);
}

const signal::DifferenceModel& cancelling_model(const SubjectResult& result) {
  const Identification& found = result.identification;
  return found.paper_unusable.empty() ? found.paper.model : found.refined.model;
}

}  // namespace

report::Figure estimate_figure(const Identification& found, const std::string& name,
                               const std::string& caption) {
  Panel magnitude = bode_panel("", "|F'/A| [dB re 1 N per m/s²]", Scale::kLinear);
  Panel phase = bode_panel("", "phase [°]", Scale::kDegrees);
  Panel coherence = bode_panel("", "coherence [-]", Scale::kLinear);
  phase.y.low = -360.0;
  phase.y.high = 0.0;
  coherence.y.low = 0.0;
  coherence.y.high = 1.05;
  magnitude.x.label = phase.x.label = "";
  add_estimate(magnitude, phase, coherence, found.estimate);
  if (found.paper_unusable != "unstable") {
    add_model(magnitude, phase, found.paper.model, "paper's fit (Eqs 3 to 5)", Colour::kModel,
              Kind::kLine);
  }
  add_model(magnitude, phase, found.refined.model, "output-error fit", Colour::kAccent,
            Kind::kDashedLine);
  phase.legend = coherence.legend = report::Legend::kNone;
  return {.name = name,
          .caption = caption,
          .panels = {magnitude, phase, coherence},
          .columns = 1,
          .width_px = 860,
          .height_px = 760};
}

report::Figure figure_estimate(const StudyRecord& record) {
  const std::size_t typical = typical_subject(record);
  return estimate_figure(
      record.results[typical].identification, "fig04_feedthrough_estimate",
      fmt::format("The paper's Fig. 4: feedthrough of {} by cross-spectrum over spectrum, with "
                  "its 95 % band and coherence, and the fitted models. The motion is strongest "
                  "from 0.7 to 4 Hz and ends at 12.6 Hz.",
                  subject_name(record, typical)));
}

report::Figure figure_models(const StudyRecord& record) {
  const std::size_t shown = std::min(record.results.size(), kMostSmallPlots);
  const std::size_t columns = std::min<std::size_t>(shown, 4);
  report::Figure figure{
      .name = "fig06_feedthrough_models",
      .caption =
          "The paper's Fig. 6: the model that cancelled for each subject; in grey the models of "
          "all "
          "other subjects shown. The paper reports about 10 dB at 0 Hz, a notch between 5 and 8 Hz "
          "with a small peak after it, and 180° at both ends.",
      .panels = {},
      .columns = static_cast<int>(columns),
      .width_px = 960,
      .height_px = static_cast<int>(330 * ((shown + columns - 1) / columns))};
  for (std::size_t first = 0; first < shown; first += columns) {
    std::vector<Panel> phases;
    for (std::size_t i = first; i < first + columns; ++i) {
      Panel magnitude = bode_panel("", i == first ? "|F'/A| [dB]" : "", Scale::kLinear);
      Panel phase = bode_panel("", i == first ? "phase [°]" : "", Scale::kDegrees);
      if (i < shown) magnitude.title = subject_name(record, i);
      magnitude.blank = phase.blank = i >= shown;
      magnitude.legend = phase.legend = report::Legend::kNone;
      magnitude.x.label = "";
      magnitude.y.low = -20.0;
      magnitude.y.high = 20.0;
      magnitude.y.tick_step = 20.0;
      phase.y.low = -360.0;
      phase.y.high = 0.0;
      for (std::size_t other = 0; other < shown && i < shown; ++other) {
        add_model(magnitude, phase, cancelling_model(record.results[other]), "", Colour::kNeutral,
                  Kind::kLine);
        magnitude.series.back().line_width_px = phase.series.back().line_width_px = 0.4;
      }
      if (i < shown) {
        add_model(magnitude, phase, cancelling_model(record.results[i]), "", Colour::kModel,
                  Kind::kLine);
      }
      figure.panels.push_back(magnitude);
      phases.push_back(phase);
    }
    figure.panels.insert(figure.panels.end(), phases.begin(), phases.end());
  }
  return figure;
}

}  // namespace stillhand::study
