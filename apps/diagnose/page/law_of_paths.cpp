// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "apps/diagnose/page/binned_series.hpp"
#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/law_parts.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "services/core/diagnosis/effect_sizes.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::SizeCase;
using diagnosis::Stage;
using report::Kind;
using report::Panel;
using report::Series;

constexpr double kTwoSided = 1.96;   // standard errors for 95 %
constexpr double kLargestBar = 0.5;  // of a magnitude: a line with a larger one is not drawn

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

const diagnosis::Signal& driving(const Evidence& evidence, const Effect& effect) {
  return effect.channels.empty() ? evidence.signals.inputs().front()
                                 : evidence.signals.at(effect.channels.front());
}

// What the record itself says of the path: bars of 95 %.
void add_measured(const Evidence& evidence, const diagnosis::Signal& from, const EffectTrace& trace,
                  const diagnosis::ExcitedBand& band, Panel& magnitude, Panel& phase) {
  std::size_t segment = 256;
  while (segment > 16 && segment * 8 > evidence.signals.size()) segment /= 2;
  const auto estimate = signal::transfer_estimate(
      signal::cross_spectra(from.values, trace.without, evidence.signals.rate_hz(), segment));
  Series size{.label = "record, without it",
              .kind = Kind::kErrorBars,
              .colour = kBefore,
              .point_size = 0.8};
  Series turn = size;
  for (std::size_t k = 1; k + 1 < estimate.response.size(); ++k) {
    const double f_hz = estimate.frequency_hz[k];
    const double error = estimate.magnitude_ci95[k];
    if (!(error < kLargestBar) || f_hz < band.low_hz || f_hz > band.high_hz) continue;
    const double m = std::abs(estimate.response[k]);
    const double p = degrees(std::arg(estimate.response[k]));
    size.x.push_back(f_hz);
    size.y.push_back(m);
    size.y_low.push_back(m * (1.0 - error));
    size.y_high.push_back(m * (1.0 + error));
    turn.x.push_back(f_hz);
    turn.y.push_back(p);
    turn.y_low.push_back(p - degrees(std::asin(error)));
    turn.y_high.push_back(p + degrees(std::asin(error)));
  }
  if (size.x.empty()) return;
  magnitude.series.push_back(std::move(size));
  phase.series.push_back(std::move(turn));
}

}  // namespace

void add_with_band(const std::string& label, const std::vector<double>& x,
                   const std::vector<double>& y, const std::vector<double>& error, Panel& panel) {
  Series band{.label = "95 %", .kind = Kind::kBand, .colour = report::Colour::kModel, .x = x};
  for (std::size_t i = 0; i < x.size(); ++i) {
    band.y_low.push_back(y[i] - kTwoSided * error[i]);
    band.y_high.push_back(y[i] + kTwoSided * error[i]);
  }
  panel.series.insert(panel.series.begin(), std::move(band));
  panel.series.push_back(
      {.label = label, .kind = Kind::kLine, .colour = report::Colour::kModel, .x = x, .y = y});
}

Law path_law(const Evidence& evidence, const SizeCase& at, const EffectTrace& trace) {
  const diagnosis::Signal& from = driving(evidence, at.effect());
  const auto band =
      diagnosis::excited_band(from.name, from.values, from.mean, evidence.signals.rate_hz());
  const double low_hz = std::max(band.low_hz, 1.0 / evidence.signals.duration_s());
  std::vector<double> f_hz;
  for (std::size_t i = 0; i < kLawPoints; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kLawPoints - 1);
    f_hz.push_back(low_hz * std::pow(std::max(band.high_hz / low_hz, 1.0), share));
  }
  std::vector<double> m;
  std::vector<double> m_error;
  std::vector<double> p;
  std::vector<double> p_error;
  for (const auto& point : diagnosis::path_response(at, evidence.errors, f_hz)) {
    m.push_back(std::abs(point.response));
    m_error.push_back(point.magnitude_error);
    p.push_back(degrees(std::arg(point.response)));
    p_error.push_back(degrees(point.phase_error_rad));
  }
  if (m.empty()) return {};
  Panel magnitude;
  Panel phase;
  magnitude.x = phase.x = {.label = "frequency [Hz]", .scale = report::Scale::kLogarithmic};
  magnitude.y.label = axis_label("magnitude from " + from.name,
                                 diagnosis::unit_over(evidence.found.output_unit, from.unit));
  magnitude.y.low = 0.0;
  phase.y = {.label = "phase [°]", .scale = report::Scale::kDegrees, .low = -180.0, .high = 180.0};
  add_measured(evidence, from, trace, band, magnitude, phase);
  add_with_band("the path", f_hz, m, m_error, magnitude);
  add_with_band("the path", f_hz, p, p_error, phase);
  return {{magnitude, phase},
          "Magnitude and phase of the path, with the 95 % band of its numbers. Bars: the response "
          "that the record shows, 95 %."};
}

Law map_law(const Evidence& evidence, const SizeCase& at, const EffectTrace& trace) {
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(at.effect().kind);
  const bool at_input = kind.stage(at.effect()) == Stage::kInputValue;
  const diagnosis::Signal& from = driving(evidence, at.effect());
  const std::vector<double>& before = at_input ? from.values : trace.run.prediction;
  const std::vector<double>& weight = evidence.after.run.weight;
  const BinAxis axis = axis_over(before, weight, kLawBins);
  std::vector<double> x;
  for (std::size_t i = 0; i < kLawPoints; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kLawPoints - 1);
    x.push_back(axis.low + share * (axis.high - axis.low));
  }
  const auto mapped = [&](const Model& model) {
    std::vector<double> y;
    for (const double each : x) y.push_back(kind.mapped(model.effects[at.which], each));
    return y;
  };
  Panel panel;
  const std::string unit = at_input ? from.unit : evidence.found.output_unit;
  panel.x.label = axis_label(at_input ? from.name : "output before it", unit);
  panel.y.label = axis_label(at_input ? from.name + " that acts" : "output behind it", unit);
  panel.series.push_back({.label = "without it",
                          .kind = Kind::kDottedLine,
                          .colour = report::Colour::kNeutral,
                          .x = {axis.low, axis.high},
                          .y = {axis.low, axis.high}});
  if (!at_input) {
    panel.series.push_back(with_errors("measured", kBefore,
                                       binned_means(axis, before, evidence.signals.output().values,
                                                    weight, evidence.correlation_samples)));
  }
  add_with_band("the map", x, mapped(at.model), evidence.errors.of(mapped), panel);
  return {{panel}, "The map with the 95 % band of its numbers."};
}

}  // namespace stillhand::diagnose
