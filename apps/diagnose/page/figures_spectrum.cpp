// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "apps/diagnose/page/figures.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::diagnose {
namespace {

using report::Kind;
using report::Panel;
using report::Scale;
using report::Series;

constexpr std::size_t kMostLines = 2048;
constexpr std::size_t kFewestSegments = 8;
struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> density;  // [unit^2/Hz]
};

std::size_t segment_of(const diagnosis::Signals& signals) {
  std::size_t longest = 0;
  for (const diagnosis::Stretch& stretch : signals.stretches()) {
    longest = std::max(longest, stretch.end - stretch.first);
  }
  std::size_t segment = 2 * kMostLines;
  while (segment > 16 && (segment > longest || segment * kFewestSegments / 2 > signals.size())) {
    segment /= 2;
  }
  return segment;
}

// Mean over the stretches, each by its averages; scaled to samples that count.
Spectrum spectrum_of(const std::vector<double>& x, const std::vector<double>& weight,
                     const diagnosis::Signals& signals) {
  const std::size_t segment = segment_of(signals);
  Spectrum result;
  double averages = 0.0;
  double samples = 0.0;
  double counted = 0.0;
  for (const diagnosis::Stretch& stretch : signals.stretches()) {
    if (stretch.end - stretch.first < segment) continue;
    const std::vector<double> part(x.begin() + static_cast<std::ptrdiff_t>(stretch.first),
                                   x.begin() + static_cast<std::ptrdiff_t>(stretch.end));
    const auto spectra = signal::cross_spectra(part, part, signals.rate_hz(), segment);
    result.frequency_hz = spectra.frequency_hz;
    result.density.resize(spectra.s_xx.size());
    for (std::size_t k = 0; k < spectra.s_xx.size(); ++k) {
      result.density[k] += spectra.independent_averages * spectra.s_xx[k];
    }
    averages += spectra.independent_averages;
    samples += static_cast<double>(part.size());
    for (std::size_t n = stretch.first; n < stretch.end; ++n) counted += weight[n];
  }
  for (double& each : result.density) each *= samples / std::max(averages * counted, 1e-300);
  if (!result.density.empty()) {  // 0 Hz has no place on a logarithmic axis
    result.density.erase(result.density.begin());
    result.frequency_hz.erase(result.frequency_hz.begin());
  }
  return result;
}

Series spectrum_series(const char* label, report::Colour colour, double width_px,
                       const Spectrum& spectrum) {
  return {.label = label,
          .kind = Kind::kLine,
          .colour = colour,
          .x = spectrum.frequency_hz,
          .y = spectrum.density,
          .line_width_px = width_px};
}

Series bound_line(double bound, double longest_s, bool in_legend) {
  return {.label = "99 % of white noise",
          .kind = Kind::kDashedLine,
          .colour = report::Colour::kNeutral,
          .x = {0.0, longest_s},
          .y = {bound, bound},
          .line_width_px = 1.4,
          .show_in_legend = in_legend};
}

}  // namespace

// The axis ends below the residuals: a filtered output may end many decades further down.
void end_below(const std::vector<Series>& residuals, Panel& panel) {
  constexpr double kRoom = 0.3;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Series& each : residuals) {
    for (const double y : each.y) {
      if (y > 0.0) lowest = std::min(lowest, y);
    }
  }
  if (std::isfinite(lowest)) panel.y.low = kRoom * lowest;
}

report::Figure figure_spectra(const Evidence& evidence) {
  const diagnosis::Diagnosis& found = evidence.found;
  const diagnosis::Signals& signals = evidence.signals;
  const std::vector<double> all(signals.size(), 1.0);
  Panel panel;
  panel.x = {.label = "frequency [Hz]", .scale = Scale::kLogarithmic};
  const std::string square = shown_unit(diagnosis::unit_power(found.output_unit, 2));
  panel.y = {.label = "PSD [" + (square == "-" ? "1" : square) + "/Hz]",
             .scale = Scale::kLogarithmic};
  const Spectrum output = spectrum_of(signals.output().values, all, signals);
  if (!output.frequency_hz.empty()) {
    panel.x.low = output.frequency_hz.front();
    panel.x.high = output.frequency_hz.back();
  }
  for (const double bound_hz : {signals.lowest_excited_hz(), signals.highest_excited_hz()}) {
    panel.reference_lines.push_back({report::Direction::kVertical, bound_hz});
  }
  panel.series.push_back(spectrum_series("output", report::Colour::kMeasured, 1.4, output));
  std::vector<Series> residuals{
      spectrum_series("baseline's residual", kBefore, 1.6,
                      spectrum_of(evidence.before.residual, evidence.before.run.weight, signals))};
  if (!found.effects.empty()) {
    residuals.push_back(
        spectrum_series("residual with the effects", kAfter, 1.8,
                        spectrum_of(evidence.after.residual, evidence.after.run.weight, signals)));
  }
  end_below(residuals, panel);
  panel.series.insert(panel.series.end(), residuals.begin(), residuals.end());
  return {.name = "residual_spectra",
          .caption = "Power spectral densities after Welch. The inputs excite " +
                     report::short_number(signals.lowest_excited_hz()) + " to " +
                     report::short_number(signals.highest_excited_hz()) +
                     " Hz, between the vertical lines; outside of them the model only leaves what "
                     "is not of the inputs.",
          .panels = {panel},
          .width_px = 980,
          .height_px = 420};
}

report::Figure figure_autocorrelation(const Evidence& evidence) {
  const diagnosis::Diagnosis& found = evidence.found;
  Panel panel;
  panel.x.label = "lag [s]";
  panel.y.label = "autocorrelation [-]";
  const auto add = [&](const char* label, const diagnosis::Whiteness& whiteness,
                       report::Colour colour) {
    Series series{
        .label = label, .kind = Kind::kLine, .colour = colour, .y = whiteness.autocorrelation};
    for (std::size_t lag = 0; lag < series.y.size(); ++lag) {
      series.x.push_back(static_cast<double>(lag) / evidence.signals.rate_hz());
    }
    panel.series.push_back(series);
  };
  const auto& whiteness = found.after.whiteness;
  const auto lags = static_cast<double>(std::max<std::size_t>(whiteness.autocorrelation.size(), 2));
  const double longest_s = (lags - 1.0) / evidence.signals.rate_hz();
  panel.series = {bound_line(whiteness.bound, longest_s, true),
                  bound_line(-whiteness.bound, longest_s, false)};
  add("baseline's residual", found.before.whiteness, kBefore);
  const bool both = !found.effects.empty();
  if (both) add("residual with the effects", whiteness, kAfter);
  panel.x.low = 0.0;
  panel.x.high = longest_s;
  return {.name = "autocorrelation",
          .caption = "Autocorrelation of the residual. Outside the bounds: " +
                     percent(found.before.whiteness.share_outside, 0) + " of the lags" +
                     (both ? " before, " + percent(whiteness.share_outside, 0) + " after" : "") +
                     "; white noise has 1 %. Coloured noise does this too: it alone does not show "
                     "a missing effect.",
          .panels = {panel},
          .width_px = 980,
          .height_px = 320};
}

}  // namespace stillhand::diagnose
