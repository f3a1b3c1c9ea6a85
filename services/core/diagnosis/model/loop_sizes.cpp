// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/loop_sizes.hpp"

#include <cmath>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop.hpp"

namespace stillhand::diagnosis {
namespace {

LoopPath path_of(const SizeCase& at) { return loop_path(at.effect(), at.model.body.order()); }

Nonlinearity nonlinearity_of(const SizeCase& at) {
  return effect_kind(at.effect().kind).feedback(at.effect());
}

// Of phi where it rests, the same for both directions; that of |z| is 0.
double slope_at_rest(const SizeCase& at) {
  constexpr double kSmall = 1e-4;
  const Nonlinearity nonlinearity = nonlinearity_of(at);
  const auto after_rest = [&](double z) {
    LoopMemory memory;
    nonlinearity.phi(0.0, memory);
    return nonlinearity.phi(z, memory);
  };
  return (after_rest(kSmall) - after_rest(-kSmall)) / (2.0 * kSmall);
}

std::complex<double> response(const std::vector<double>& c, const SizeCase& at, double hz) {
  return polynomial_at(c, hz, at.model.rate_hz);
}

double stiffness(const SizeCase& at, double slope) {
  const LoopPath path = path_of(at);
  const double back = path.of_output()
                          ? response(path.e, at, 0.0).real() / nonlinearity_of(at).threshold
                          : response(path.m, at, 0.0).real();
  return response(at.model.body.denominator, at, 0.0).real() - slope * back;
}

}  // namespace

double largest_argument(const SizeCase& at) {
  const LoopPath path = path_of(at);
  if (path.of_output()) return at.largest_argument / nonlinearity_of(at).threshold;
  return at.largest_argument * std::abs(response(path.n, at, at.centre_hz));
}

double output_over_argument(const SizeCase& at) {
  const LoopPath path = path_of(at);
  if (path.of_output()) return nonlinearity_of(at).threshold;
  const double slope = slope_at_rest(at);
  const double hz = at.centre_hz;
  const auto a = response(at.model.body.denominator, at, hz);
  const auto z = response(path.n, at, hz) / (a - slope * response(path.m, at, hz));
  const auto b = response(at.model.body.numerators.front(), at, hz);
  const auto ratio = (b + slope * response(path.e, at, hz) * z) / a / z;
  return std::copysign(std::abs(ratio), ratio.real());
}

double output_over_phi(const SizeCase& at) {
  return response(path_of(at).e, at, 0.0).real() /
         response(at.model.body.denominator, at, 0.0).real();
}

Size stiffness_ratio(const SizeCase& at, double there, double here, const std::string& meaning) {
  return {"stiffness_ratio", "-", stiffness(at, there) / stiffness(at, here), meaning};
}

Size force_at_threshold(const SizeCase& at, const std::string& name, double thresholds,
                        const std::string& meaning) {
  Size size{name, at.model.output_unit, thresholds * std::abs(output_over_argument(at)), meaning};
  if (!path_of(at).of_output()) size.at_hz = at.centre_hz;
  return size;
}

}  // namespace stillhand::diagnosis
