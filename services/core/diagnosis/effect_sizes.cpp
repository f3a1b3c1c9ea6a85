// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effect_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"

namespace stillhand::diagnosis {
namespace {

std::size_t fitted_count(const Effect& effect) {
  if (!effect.is_whole()) return 0;
  return effect.coefficients.size() +
         static_cast<std::size_t>(std::ranges::count_if(effect.parameters, &Parameter::fitted));
}

// Two digits: a frequency that is stated with the number.
double rounded(double value) {
  if (!(value > 0.0)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::round(value / unit) * unit;
}

// Eq. DG-72
double centre_hz(const Signal& signal, const Signals& signals) {
  const ExcitedBand band = excited_band(signal.name, signal.values, signal.mean, signals.rate_hz());
  const double low_hz = std::max(band.low_hz, 1.0 / signals.duration_s());
  return rounded(std::sqrt(low_hz * std::max(band.high_hz, low_hz)));
}

std::string origin_of(const Parameter& parameter) {
  if (parameter.fitted) return "fitted";
  return parameter.lower < parameter.upper ? "searched" : "given";
}

void add_coefficients(const SizeCase& at, const NumberErrors& errors, std::vector<Size>& sizes) {
  const Effect& effect = at.effect();
  const EffectKind& kind = effect_kind(effect.kind);
  if (kind.stage(effect) != Stage::kTerm || kind.through_body(effect)) return;
  const std::size_t first = first_number(at.model, at.which);
  const std::size_t count = effect.coefficients.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::string under = kind.column_unit(effect, at.signals, i);
    const std::string& over = at.model.output_unit;
    Size size{count == 1 ? "coefficient" : "coefficient_" + std::to_string(i + 1),
              under.empty() ? over + " per unit of the term" : unit_over(over, under),
              effect.coefficients[i]};
    size.std_error = errors.of_number(first + i);
    size.origin = "fitted";
    sizes.push_back(std::move(size));
  }
}

void add_parameters(const SizeCase& at, const NumberErrors& errors, std::vector<Size>& sizes) {
  std::size_t place = first_number(at.model, at.which) + at.effect().coefficients.size();
  for (const Parameter& parameter : at.effect().parameters) {
    Size size{parameter.name, parameter.unit, parameter.value};
    size.origin = origin_of(parameter);
    if (parameter.fitted) size.std_error = errors.of_number(place++);
    sizes.push_back(std::move(size));
  }
}

SizeCase with(const SizeCase& at, const Model& model) {
  return {model, at.which, at.signals, at.centre_hz, at.largest_argument};
}

}  // namespace

std::size_t first_number(const Model& model, std::size_t which) {
  std::size_t place = 1 + model.body.order();
  for (const auto& numerator : model.body.numerators) place += numerator.size();
  for (std::size_t e = 0; e < which; ++e) place += fitted_count(model.effects[e]);
  return place;
}

SizeCase size_case(const Model& model, std::size_t which, const Signals& signals,
                   const FreeRun& run) {
  const Effect& effect = model.effects.at(which);
  SizeCase result{model, which, signals};
  result.centre_hz = centre_hz(
      effect.channels.empty() ? signals.inputs().front() : signals.at(effect.channels.front()),
      signals);
  if (!acts_at(effect, Stage::kFeedback) || run.argument.empty()) {
    return result;
  }
  result.largest_argument = largest_deflection(run.argument, 0.0, signals);
  const LoopPath path = loop_path(effect, model.body.order());
  if (!path.of_output()) {
    result.largest_argument /= std::abs(polynomial_at(path.n, result.centre_hz, model.rate_hz));
  }
  return result;
}

std::vector<Size> effect_sizes(const SizeCase& at, const NumberErrors& errors) {
  const EffectKind& kind = effect_kind(at.effect().kind);
  std::vector<Size> sizes = kind.sizes(at);
  const std::vector<double> own = errors.of([&](const Model& model) {
    std::vector<double> values;
    for (const Size& size : kind.sizes(with(at, model))) values.push_back(size.value);
    return values;
  });
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i].std_error = own[i];
  add_coefficients(at, errors, sizes);
  add_parameters(at, errors, sizes);
  return sizes;
}

std::vector<ResponsePoint> path_response(const SizeCase& at, const NumberErrors& errors,
                                         const std::vector<double>& frequencies_hz) {
  const EffectKind& kind = effect_kind(at.effect().kind);
  std::vector<ResponsePoint> points;
  for (const double frequency_hz : frequencies_hz) {
    const auto response = kind.path(at, frequency_hz);
    if (!response) return {};
    points.push_back({frequency_hz, *response, 0.0, 0.0});
  }
  // The logarithm's parts are those of magnitude and phase, without turns between two models.
  const std::vector<double> own = errors.of([&](const Model& model) {
    std::vector<double> values;
    for (const ResponsePoint& point : points) {
      const auto moved = std::log(*kind.path(with(at, model), point.frequency_hz) / point.response);
      values.push_back(moved.real());
      values.push_back(moved.imag());
    }
    return values;
  });
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].magnitude_error = own[2 * i] * std::abs(points[i].response);
    points[i].phase_error_rad = own[2 * i + 1];
  }
  return points;
}

}  // namespace stillhand::diagnosis
