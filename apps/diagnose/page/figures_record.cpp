// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/excerpt.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::diagnose {
namespace {

using report::Kind;
using report::Panel;
using report::Series;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

struct Section {
  std::size_t first;
  std::size_t end;
};

// Samples that the figure shows: within one stretch, where the effects explain most.
Section shown_section(const Evidence& evidence) {
  const std::size_t wanted =
      report::excerpt_length(evidence.signals.output().values, evidence.signals.rate_hz());
  const std::size_t middle = evidence.signals.size() / 2;
  Section best{0, 0};
  double most = -HUGE_VAL;
  for (const diagnosis::Stretch& stretch : evidence.signals.stretches()) {
    const std::size_t length = std::min(wanted, stretch.end - stretch.first);
    const std::size_t step = std::max<std::size_t>(length / 8, 1);
    for (std::size_t first = stretch.first; first + length <= stretch.end; first += step) {
      double gain = 0.0;
      for (std::size_t n = first; n < first + length; ++n) {
        gain += std::pow(evidence.before.residual[n], 2) - std::pow(evidence.after.residual[n], 2);
      }
      if (evidence.found.effects.empty()) {
        const double centre = static_cast<double>(first) + 0.5 * static_cast<double>(length);
        gain = static_cast<double>(length) - std::abs(centre - static_cast<double>(middle));
      }
      if (gain <= most) continue;
      most = gain;
      best = {first, first + length};
    }
  }
  return best;
}

Series line(const std::string& label, report::Colour colour, Kind kind, double width_px) {
  return {.label = label, .kind = kind, .colour = colour, .line_width_px = width_px};
}

// Output less residual where the sample counts: the free run with its initial state.
double predicted(const Evidence& evidence, const ModelRun& model, std::size_t n) {
  if (model.run.weight[n] > 0.0) return evidence.signals.output().values[n] - model.residual[n];
  return model.run.prediction[n];
}

double left(const ModelRun& model, std::size_t n) {
  return model.run.weight[n] > 0.0 ? model.residual[n] : kGap;
}

}  // namespace

report::Figure figure_prediction(const Evidence& evidence) {
  const bool found = !evidence.found.effects.empty();
  const diagnosis::Signal& output = evidence.signals.output();
  const Section section = shown_section(evidence);
  Series measured = line("measured", report::Colour::kMeasured, Kind::kLine, 2.2);
  Series baseline = line("baseline", kBefore, found ? Kind::kDashedLine : Kind::kLine, 1.5);
  Series final_run = line("with the effects", kAfter, Kind::kLine, 1.5);
  Series left_before = line("baseline's residual", kBefore, Kind::kLine, 1.3);
  Series left_after = line("residual with the effects", kAfter, Kind::kLine, 1.3);
  for (std::size_t n = section.first; n < section.end; ++n) {
    measured.x.push_back(evidence.signals.time_s()[n]);
    measured.y.push_back(evidence.working.weight[n] > 0.0 ? output.values[n] : kGap);
    baseline.y.push_back(predicted(evidence, evidence.before, n));
    final_run.y.push_back(predicted(evidence, evidence.after, n));
    left_before.y.push_back(left(evidence.before, n));
    left_after.y.push_back(left(evidence.after, n));
  }
  baseline.x = final_run.x = left_before.x = left_after.x = measured.x;
  Panel above;
  above.y.label = axis_label(output.name, output.unit);
  above.series = {measured, baseline};
  Panel below;
  below.x.label = "time [s]";
  below.y.label = axis_label("residual", output.unit);
  below.series = {left_before};
  if (found) {
    above.series.push_back(final_run);
    below.series.push_back(left_after);
  }
  for (Panel* panel : {&above, &below}) {
    panel->x.low = measured.x.front();
    panel->x.high = measured.x.back();
  }
  return {
      .name = "prediction",
      .caption = std::string("Above: measurement and free run, ") +
                 (found ? "where the effects explain most" : "in the middle of the record") +
                 ". Below: the residuals. The models get the inputs alone. Here they are fitted to "
                 "the whole record; the table of errors is of held-out data. In a gap, samples "
                 "have no weight.",
      .panels = {above, below},
      .width_px = 980,
      .height_px = 560};
}

report::Figure figure_over_time(const Evidence& evidence) {
  const diagnosis::Diagnosis& found = evidence.found;
  Panel panel;
  panel.x.label = "time [s]";
  panel.y.label = axis_label("RMS of the residual", found.output_unit);
  panel.y.low = 0.0;
  const auto add = [&panel](const char* label, const diagnosis::Spread& spread,
                            report::Colour colour) {
    panel.series.push_back({.label = label,
                            .kind = Kind::kLineAndPoints,
                            .colour = colour,
                            .x = spread.time_s,
                            .y = spread.rms});
  };
  const auto& times = found.before.spread.time_s;
  if (times.size() > 1) {
    Series floor{.kind = Kind::kBand,
                 .colour = report::Colour::kNeutral,
                 .x = {times.front(), times.back()},
                 .show_in_legend = false};
    floor.y_low.assign(2, found.noise_floor.low);
    floor.y_high.assign(2, found.noise_floor.high);
    panel.series.push_back(floor);
    floor.label = "noise floor";
    floor.kind = Kind::kDottedLine;
    floor.y.assign(2, found.noise_floor.rmse);
    floor.show_in_legend = true;
    panel.series.push_back(floor);
  }
  add("baseline", found.before.spread, kBefore);
  const bool both = !found.effects.empty();
  if (both) add("with the effects", found.after.spread, kAfter);
  return {
      .name = "residual_over_time",
      .caption =
          "RMS of the residual in each block. Largest block over median block: " +
          report::number(found.before.spread.largest_ratio, 2) +
          (both ? " before, " + report::number(found.after.spread.largest_ratio, 2) + " after"
                : "") +
          ". Noise that varies over time is not an effect. Grey: the noise floor and its interval.",
      .panels = {panel},
      .width_px = 980,
      .height_px = 320};
}

}  // namespace stillhand::diagnose
