// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/effect_numbers.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "apps/diagnose/page/wording.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Model;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The poles that turn upward, as natural frequency and damping ratio, in turn.
std::vector<double> modes_of(const Model& model, std::vector<bool>* pairs) {
  const auto poles = signal::poles({1.0, model.body.denominator, model.body.denominator});
  std::vector<double> modes;
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() < -1e-9 || std::abs(pole) <= 0.0) continue;
    const std::complex<double> s = std::log(pole) * model.rate_hz;
    modes.push_back(std::abs(s) / (2.0 * std::numbers::pi));
    modes.push_back(-s.real() / std::abs(s));
    if (pairs != nullptr) pairs->push_back(pole.imag() > 1e-9);
  }
  return modes;
}

// Two real poles may meet and part as a pair: then they have no errors.
std::vector<double> errors_of_modes(const Evidence& evidence, std::size_t count) {
  return evidence.errors.of([count](const Model& model) {
    std::vector<double> modes = modes_of(model, nullptr);
    if (modes.size() != count) modes.assign(count, kUnknown);
    return modes;
  });
}

void add_poles(const Evidence& evidence, std::vector<ModelNumber>& numbers) {
  std::vector<bool> pairs;
  const std::vector<double> modes = modes_of(evidence.found.model, &pairs);
  const std::vector<double> errors = errors_of_modes(evidence, modes.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string name = "pole " + std::to_string(i + 1) + (pairs[i] ? " (pair)" : " (real)");
    // It has no sign: an error as large as itself says nothing of it.
    const double error = errors[2 * i] < modes[2 * i] ? errors[2 * i] : kUnknown;
    numbers.push_back({name + ": natural frequency", modes[2 * i], error, "Hz", "fitted"});
    if (!pairs[i]) continue;  // 1 by definition
    numbers.push_back(
        {name + ": damping ratio", modes[2 * i + 1], errors[2 * i + 1], "-", "fitted"});
  }
}

// Gain at 0 Hz from each input.
std::vector<double> gains_of(const Model& model) {
  const auto sum = [](const std::vector<double>& c) {
    return std::accumulate(c.begin(), c.end(), 0.0);
  };
  std::vector<double> gains;
  for (const auto& numerator : model.body.numerators) {
    gains.push_back(sum(numerator) / sum(model.body.denominator));
  }
  return gains;
}

}  // namespace

std::vector<ModelNumber> effect_numbers(const Evidence& evidence, std::size_t which) {
  std::vector<ModelNumber> numbers;
  for (const diagnosis::Size& size : evidence.found.effects.at(which).sizes) {
    std::string name = spaced(size.name);
    if (size.at_hz) name += " at " + shown(*size.at_hz, "Hz");
    if (!size.meaning.empty()) name += ", " + size.meaning;
    numbers.push_back(
        {std::move(name), size.value, size.std_error, shown_unit(size.unit), size.origin});
  }
  return numbers;
}

std::vector<ModelNumber> body_numbers(const Evidence& evidence) {
  const Model& model = evidence.found.model;
  const std::string& output = evidence.found.output_unit;
  std::vector<ModelNumber> numbers{
      {"offset", model.body.offset, evidence.errors.of_number(0), shown_unit(output), "fitted"}};
  const bool is_static = model.body.order() == 0;
  const std::vector<double> gains = gains_of(model);
  const std::vector<double> errors = evidence.errors.of(gains_of);
  for (std::size_t k = 0; k < gains.size(); ++k) {
    numbers.push_back({(is_static ? "factor of " : "gain at 0 Hz from ") + model.inputs[k],
                       gains[k], errors[k], unit_ratio(output, evidence.signals.inputs()[k].unit),
                       "fitted"});
  }
  if (!is_static) add_poles(evidence, numbers);
  return numbers;
}

}  // namespace stillhand::diagnose
