// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/effect_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "apps/diagnose/page/wording.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/signal/difference_model.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::Parameter;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::size_t body_count(const Model& model) {
  std::size_t count = 1 + model.body.order();
  for (const auto& numerator : model.body.numerators) count += numerator.size();
  return count;
}

std::size_t packed_count(const Effect& effect) {
  return effect.coefficients.size() +
         static_cast<std::size_t>(std::ranges::count_if(effect.parameters, &Parameter::fitted));
}

std::string origin_of(const Parameter& parameter) {
  if (parameter.fitted) return "fitted";
  return parameter.lower < parameter.upper ? "searched" : "given";
}

void add_poles(const Model& model, std::vector<ModelNumber>& numbers) {
  const auto poles = signal::poles({1.0, model.body.denominator, model.body.denominator});
  int next = 0;
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() < -1e-9 || std::abs(pole) <= 0.0) continue;
    const std::complex<double> s = std::log(pole) * model.rate_hz;
    const std::string name = "pole " + std::to_string(++next);
    const std::string pair = pole.imag() > 1e-9 ? " (pair)" : "";
    numbers.push_back({name + pair + ": natural frequency", std::abs(s) / (2.0 * std::numbers::pi),
                       kUnknown, "Hz", "fitted"});
    numbers.push_back(
        {name + pair + ": damping ratio", -s.real() / std::abs(s), kUnknown, "-", "fitted"});
  }
}

}  // namespace

std::size_t first_number(const Model& model, std::size_t which) {
  std::size_t place = body_count(model);
  for (std::size_t e = 0; e < which; ++e) place += packed_count(model.effects.at(e));
  return place;
}

std::vector<ModelNumber> effect_numbers(const Evidence& evidence, std::size_t which) {
  const Model& model = evidence.found.model;
  const Effect& effect = model.effects.at(which);
  std::size_t place = first_number(model, which);
  const auto& kind = diagnosis::effect_kind(effect.kind);
  const bool named = kind.stage(effect) == diagnosis::Stage::kTerm && !kind.through_body(effect);
  std::vector<ModelNumber> numbers;
  for (std::size_t i = 0; i < effect.coefficients.size(); ++i, ++place) {
    if (!named) continue;
    const std::string under = kind.column_unit(effect, evidence.signals, i);
    const std::string over = evidence.found.output_unit;
    numbers.push_back(
        {effect.coefficients.size() == 1 ? "coefficient" : "coefficient " + std::to_string(i + 1),
         effect.coefficients[i], evidence.standard_errors.at(place),
         under.empty() ? shown_unit(over) + " per unit of the term" : unit_ratio(over, under),
         "fitted"});
  }
  for (const Parameter& parameter : effect.parameters) {
    const double error = parameter.fitted ? evidence.standard_errors.at(place++) : kUnknown;
    numbers.push_back({spaced(parameter.name), parameter.value, error, shown_unit(parameter.unit),
                       origin_of(parameter)});
  }
  return numbers;
}

std::vector<ModelNumber> body_numbers(const Evidence& evidence) {
  const Model& model = evidence.found.model;
  const std::string& output = evidence.found.output_unit;
  std::vector<ModelNumber> numbers{
      {"offset", model.body.offset, evidence.standard_errors.at(0), shown_unit(output), "fitted"}};
  const bool is_static = model.body.order() == 0;
  const auto sum = [](const std::vector<double>& c) {
    return std::accumulate(c.begin(), c.end(), 0.0);
  };
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    const std::string unit = unit_ratio(output, evidence.signals.inputs()[k].unit);
    numbers.push_back({(is_static ? "factor of " : "gain at 0 Hz from ") + model.inputs[k],
                       sum(model.body.numerators[k]) / sum(model.body.denominator),
                       is_static ? evidence.standard_errors.at(1 + k) : kUnknown, unit, "fitted"});
  }
  if (!is_static) add_poles(model, numbers);
  return numbers;
}

}  // namespace stillhand::diagnose
