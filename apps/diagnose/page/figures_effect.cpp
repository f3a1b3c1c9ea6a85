// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/diagnose/page/binned_series.hpp"
#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnose {
namespace {

using report::Kind;
using report::Panel;
using report::Series;

constexpr std::size_t kEffectBins = 24;

std::string effect_figure_name(std::size_t which) { return "effect_" + std::to_string(which + 1); }

// An effect that leaves samples out predicts nothing of the others, except through the refit.
bool predicts(const Evidence& evidence, std::size_t which, const EffectTrace& trace) {
  const diagnosis::Effect& effect = evidence.found.effects.at(which).effect;
  if (diagnosis::effect_kind(effect.kind).stage(effect) == diagnosis::Stage::kWeight) return false;
  for (std::size_t n = 0; n < trace.contribution.size(); ++n) {
    if (evidence.after.run.weight[n] > 0.0 && trace.contribution[n] != 0.0) return true;
  }
  return false;
}

// The residual as a function of the effect's own prediction.
Panel against_prediction(const Evidence& evidence, const EffectTrace& trace) {
  const std::vector<double>& weight = evidence.after.run.weight;
  const std::string& unit = evidence.found.output_unit;
  const BinAxis axis = axis_over(trace.contribution, weight,
                                 bins_for(weight, evidence.correlation_samples, kEffectBins));
  const BinnedMeans means =
      binned_means(axis, trace.contribution, trace.without, weight, evidence.correlation_samples);
  const Series bars = with_errors("without it", kBefore, means);
  const Series one{.label = "slope 1",
                   .kind = Kind::kDashedLine,
                   .colour = report::Colour::kNeutral,
                   .x = {axis.low, axis.high},
                   .y = {axis.low, axis.high}};
  Panel panel;
  panel.x.label = axis_label("predicted by the effect", unit);
  panel.y.label = axis_label("residual without it", unit);
  panel.series = {one, bars};
  return panel;
}

// One row of up to three, or two rows.
void arrange(report::Figure& figure) {
  const auto count = static_cast<int>(figure.panels.size());
  figure.columns = count == 4 ? 2 : count;
  if (count == 3) figure.width_px = 1280;
  if (count == 4) figure.height_px *= 2;
}

}  // namespace

report::Figure figure_effect(const Evidence& evidence, std::size_t which) {
  const EffectTrace trace = trace_of(evidence, which);
  const Explanation explanation = explanation_of(evidence, which, trace);
  const Law law = law_of(evidence, which, trace);
  const std::string text = law.takes_left ? "" : ": " + explanation.text;
  report::Figure figure{.name = effect_figure_name(which),
                        .caption = "Effect " + std::to_string(which + 1) + ", " +
                                   effect_title(evidence.found.effects.at(which)) + text + ".",
                        .panels = {},
                        .columns = 2,
                        .width_px = 980,
                        .height_px = 400};
  if (!law.takes_left) figure.panels.push_back(explanation.panel);
  if (!law.text.empty()) figure.caption += " " + law.text;
  const bool is_predicted = predicts(evidence, which, trace);
  if (is_predicted) figure.panels.push_back(against_prediction(evidence, trace));
  // Two stand side by side in the second row.
  const auto place =
      law.panels.size() == 2 ? figure.panels.end() : figure.panels.end() - (is_predicted ? 1 : 0);
  figure.panels.insert(place, law.panels.begin(), law.panels.end());
  arrange(figure);
  if (!is_predicted) return figure;
  figure.caption +=
      std::string(
          " Panel with slope 1: the residual without the effect, over what the effect "
          "predicts. ") +
      (trace.refitted ? "The model without the effect was fitted again."
                      : "The model without the effect keeps the other numbers of the joint fit.") +
      " Bars: one standard error, with one independent sample in each correlation length (" +
      report::short_number(evidence.correlation_samples / evidence.signals.rate_hz()) + " s).";
  return figure;
}

std::vector<report::Figure> diagnosis_figures(const Evidence& evidence) {
  std::vector<report::Figure> figures{figure_prediction(evidence), figure_spectra(evidence)};
  const std::size_t effects = std::min(evidence.found.effects.size(), kMostEffectFigures);
  for (std::size_t e = 0; e < effects; ++e) figures.push_back(figure_effect(evidence, e));
  figures.push_back(figure_over_time(evidence));
  // The second that is computed has hardly a lag in a slow record: no picture of a correlation.
  constexpr std::size_t kFewestLags = 5;
  if (evidence.found.before.whiteness.autocorrelation.size() > kFewestLags) {
    figures.push_back(figure_autocorrelation(evidence));
  }
  if (evidence.found.before.coherence.independent_averages > 0.0) {
    figures.push_back(figure_coherence(evidence));
  }
  if (evidence.found.before.lines && !evidence.found.before.lines->excited.empty()) {
    figures.push_back(figure_lines(evidence));
  }
  return figures;
}

std::vector<std::string> figure_names() {
  std::vector<std::string> names{"prediction", "residual_spectra"};
  for (std::size_t e = 0; e < kMostEffectFigures; ++e) names.push_back(effect_figure_name(e));
  names.insert(names.end(),
               {"residual_over_time", "autocorrelation", "partial_coherence", "detection_lines"});
  return names;
}

}  // namespace stillhand::diagnose
