// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/diagnose/page/binned_series.hpp"
#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/explaining_variable.hpp"
#include "apps/diagnose/page/explanation_over_time.hpp"
#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "services/core/diagnosis/effect_sizes.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using diagnosis::Stage;
using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

constexpr std::size_t kBins = 30;
constexpr double kTwoSided95 = 1.96;  // standard errors
constexpr double kIsFunction = 0.5;   // of the effect's variance, that a variable explains
constexpr std::size_t kFewestLines = 5;
constexpr double kLargestError = 0.5;  // of a magnitude: a line with a larger one is not drawn

Series means_line(const std::string& label, report::Colour colour, Kind kind,
                  const BinnedMeans& means) {
  return {.label = label, .kind = kind, .colour = colour, .x = means.centre, .y = means.mean};
}

std::vector<double> only(const std::vector<double>& weight, const std::vector<double>& x,
                         bool falling) {
  std::vector<double> kept = weight;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if ((n > 0 && x[n] < x[n - 1]) != falling) kept[n] = 0.0;
  }
  return kept;
}

Explanation against_variable(const Evidence& evidence, const EffectTrace& trace,
                             const Variable& variable) {
  const std::vector<double>& weight = evidence.after.run.weight;
  const double correlation = evidence.correlation_samples;
  const BinAxis axis = axis_over(variable.values, weight, bins_for(weight, correlation, kBins));
  Explanation result;
  Panel& panel = result.panel;
  panel.x.label = variable.name;
  panel.y.label = axis_label("residual without it", evidence.found.output_unit);
  const auto means = [&](const std::vector<double>& y, const std::vector<double>& counted) {
    return binned_means(axis, variable.values, y, counted, correlation);
  };
  if (!variable.by_direction) {
    panel.series = {
        means_line("left with it", kAfter, Kind::kPoints, means(evidence.after.residual, weight)),
        means_line("the effect", report::Colour::kModel, Kind::kLine,
                   means(trace.contribution, weight)),
        with_errors("without it", kBefore, means(trace.without, weight))};
    panel.series.front().point_size = 1.0;
    result.text = "means by bins of the variable that explains the effect";
    return result;
  }
  for (const bool falling : {false, true}) {
    const std::vector<double> counted = only(weight, variable.values, falling);
    const report::Colour colour = falling ? kAfter : kBefore;
    panel.series.push_back(means_line("", colour, falling ? Kind::kDashedLine : Kind::kLine,
                                      means(trace.contribution, counted)));
    panel.series.back().show_in_legend = false;
    panel.series.push_back(
        with_errors(falling ? "falling" : "rising", colour, means(trace.without, counted)));
  }
  result.text =
      "means over bins of the variable that explains the effect, separately for rising and falling "
      "values; lines: the effect";
  return result;
}

// The curve itself, with two standard errors on each side of the knots that were fitted.
Explanation as_curve(const Evidence& evidence, std::size_t which, const diagnosis::Curve& curve,
                     const EffectTrace& trace) {
  const std::string& output = evidence.found.output_unit;
  const std::size_t first = diagnosis::first_number(evidence.found.model, which);
  Series band{.label = "95 %", .kind = Kind::kBand, .colour = report::Colour::kModel};
  Series line{.label = "the effect",
              .kind = Kind::kLineAndPoints,
              .colour = report::Colour::kModel,
              .x = curve.knots,
              .y = curve.heights};
  for (std::size_t k = 0; k < curve.knots.size(); ++k) {
    const double error =
        curve.fitted[k] ? evidence.errors.of_number(first + *curve.fitted[k]) : 0.0;
    band.x.push_back(curve.knots[k]);
    band.y_low.push_back(curve.heights[k] - kTwoSided95 * error);
    band.y_high.push_back(curve.heights[k] + kTwoSided95 * error);
  }
  Explanation result;
  Panel& panel = result.panel;
  panel.x.label = axis_label(curve.over, curve.over_unit);
  panel.y.label = axis_label(
      curve.of,
      curve.pure_number ? "-" : (curve.per.empty() ? output : unit_ratio(output, curve.per)));
  panel.series = {band, line};
  const auto& all = evidence.signals.all();
  const auto over = std::ranges::find(all, curve.over, &diagnosis::Signal::name);
  if (!curve.pure_number && curve.per.empty() && over != all.end()) {
    const std::vector<double>& weight = evidence.after.run.weight;
    const double correlation = evidence.correlation_samples;
    const BinAxis axis = axis_over(over->values, weight, bins_for(weight, correlation, kBins));
    panel.series.push_back(
        with_errors("without it", kBefore,
                    binned_means(axis, over->values, trace.without, weight, correlation)));
  }
  result.text =
      "the fitted curve with the 95 % band of its numbers; the curve is zero at the knot without a "
      "band";
  return result;
}

// Lines within the excited band whose error is small enough.
Series magnitudes(const signal::TransferEstimate& response, const diagnosis::Signals& signals,
                  bool with_bars) {
  Series series{.kind = with_bars ? Kind::kErrorBars : Kind::kLine};
  for (std::size_t k = 1; k + 1 < response.response.size(); ++k) {
    const double error = response.magnitude_ci95[k];
    const double f_hz = response.frequency_hz[k];
    if (!(error < kLargestError) || f_hz < signals.lowest_excited_hz() ||
        f_hz > signals.highest_excited_hz()) {
      continue;
    }
    const double magnitude = std::abs(response.response[k]);
    series.x.push_back(f_hz);
    series.y.push_back(magnitude);
    series.y_low.push_back(magnitude * (1.0 - error));
    series.y_high.push_back(magnitude * (1.0 + error));
  }
  return series;
}

// The effect has a memory of its own: its frequency response from what drives it.
Explanation as_response(const Evidence& evidence, const Effect& effect, const EffectTrace& trace) {
  const diagnosis::Signal& from = effect.channels.empty()
                                      ? evidence.signals.inputs().front()
                                      : evidence.signals.at(effect.channels.front());
  std::size_t segment = 256;
  while (segment > 16 && segment * 8 > evidence.signals.size()) segment /= 2;
  const auto estimate = [&](const std::vector<double>& y) {
    return signal::transfer_estimate(
        signal::cross_spectra(from.values, y, evidence.signals.rate_hz(), segment));
  };
  Series measured = magnitudes(estimate(trace.without), evidence.signals, true);
  measured.label = "without it";
  measured.colour = kBefore;
  measured.point_size = 0.8;
  Series model = magnitudes(estimate(trace.contribution), evidence.signals, false);
  model.label = "the effect";
  model.colour = report::Colour::kModel;
  Explanation result;
  result.panel.x = {.label = "frequency [Hz]", .scale = Scale::kLogarithmic};
  result.panel.y = {.label = axis_label("response to " + from.name,
                                        unit_ratio(evidence.found.output_unit, from.unit)),
                    .scale = Scale::kLogarithmic};
  result.panel.series = {measured, model};
  result.text = "frequency response from " + from.name +
                " to the residual (bars: 95 %; excited lines with an error below ±50 %)";
  return result;
}

}  // namespace

Explanation explanation_of(const Evidence& evidence, std::size_t which, const EffectTrace& trace) {
  const Effect& effect = evidence.found.model.effects.at(which);
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  if (const auto curve = kind.curve(effect, evidence.signals))
    return as_curve(evidence, which, *curve, trace);
  switch (kind.stage(effect)) {
    case Stage::kInputTime:
      return lag_over_time(evidence, effect, trace);
    case Stage::kGain:
      return local_gain(evidence, which);
    case Stage::kWeight:
      return strongest_burst(evidence, trace);
    case Stage::kInputValue:
    case Stage::kFeedback:
    case Stage::kTerm:
    case Stage::kOutputValue:
      break;
  }
  const auto variable = explaining_variable(evidence, effect, trace);
  const bool in_a_loop = kind.stage(effect) == Stage::kFeedback;
  if (variable && (in_a_loop || variable->share >= kIsFunction)) {
    return against_variable(evidence, trace, *variable);
  }
  Explanation response = as_response(evidence, effect, trace);
  // An effect that has neither is drawn over its best variable.
  const bool enough_lines = response.panel.series.front().x.size() >= kFewestLines;
  return variable && !enough_lines ? against_variable(evidence, trace, *variable) : response;
}

}  // namespace stillhand::diagnose
