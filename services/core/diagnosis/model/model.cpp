// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

// A denominator 1 + q^-1 g(q) by g in the difference basis.
std::vector<double> denominator_numbers(const std::vector<double>& denominator) {
  return difference_basis({denominator.begin() + 1, denominator.end()});
}

double bound_on(const std::complex<double>& pole, const Body& body) {
  return std::abs(std::arg(pole)) >= body.least_turn ? body.largest_radius : body.slowest_radius;
}

// Of the radius of a pole z by a_1 .. a_p: dz/da_k = -z^(p-k) / P'(z), P the polynomial in z.
std::vector<double> radius_by_coefficients(const std::complex<double>& pole,
                                           const std::vector<double>& denominator) {
  const std::size_t order = denominator.size() - 1;
  std::complex<double> slope = 0.0;
  for (std::size_t k = 0; k < order; ++k) {
    slope = slope * pole + denominator[k] * static_cast<double>(order - k);
  }
  std::vector<double> by(order);
  std::complex<double> power = 1.0;
  for (std::size_t k = order; k >= 1; --k, power *= pole) {
    by[k - 1] = -(std::conj(pole) * power / slope).real() / std::abs(pole);
  }
  return by;
}

void append(const std::vector<double>& values, std::vector<double>& all) {
  all.insert(all.end(), values.begin(), values.end());
}

}  // namespace

std::vector<double> difference_basis(const std::vector<double>& coefficients) {
  // q^-1 = 1 - D, so c(q^-1) = c(1 - D): Horner's scheme with polynomials in D.
  std::vector<double> result;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) {
    result.push_back(0.0);
    for (std::size_t i = result.size(); i-- > 1;) result[i] -= result[i - 1];
    result[0] += *c;
  }
  return result;
}

std::size_t complexity(const Model& model) noexcept {
  std::size_t count = 1 + model.body.order();
  for (const auto& numerator : model.body.numerators) count += numerator.size();
  for (const Effect& effect : model.effects) count += complexity(effect);
  return count;
}

bool is_stable(const Body& body) {
  const signal::DifferenceModel model{1.0, body.denominator, body.denominator};
  if (!signal::well_formed(model) || !signal::is_stable(model)) return false;
  return std::ranges::all_of(signal::poles(model), [&](const std::complex<double>& pole) {
    return std::abs(pole) <= bound_on(pole, body);
  });
}

bool is_near_bound(const Body& body) {
  const auto poles = signal::poles({1.0, body.denominator, body.denominator});
  return std::ranges::any_of(poles, [&](const std::complex<double>& pole) {
    // A decay within half of the time: the radius squared.
    return std::abs(pole) > std::pow(bound_on(pole, body), 2);
  });
}

std::vector<Eigen::VectorXd> radii_on_bound(const Model& model) {
  constexpr double kOfDecay = 0.99;
  const Body& body = model.body;
  const std::size_t order = body.order();
  const auto count = packed(model).size();
  Eigen::Index first = 1;
  for (const auto& numerator : body.numerators) first += std::ssize(numerator);
  std::vector<Eigen::VectorXd> radii;
  for (const auto& pole : signal::poles({1.0, body.denominator, body.denominator})) {
    if (pole.imag() < 0.0 || std::abs(pole) < std::pow(bound_on(pole, body), 1.0 / kOfDecay)) {
      continue;
    }
    const std::vector<double> by = radius_by_coefficients(pole, body.denominator);
    radii.emplace_back(Eigen::VectorXd::Zero(count));
    for (std::size_t i = 0; i < order; ++i) {
      std::vector<double> one(order, 0.0);
      one[i] = 1.0;
      const std::vector<double> coefficients = difference_basis(one);
      for (std::size_t k = 0; k < order; ++k) {
        radii.back()[first + static_cast<Eigen::Index>(i)] += by[k] * coefficients[k];
      }
    }
  }
  return radii;
}

void stabilise(Body& body) {
  std::vector<std::complex<double>> poles =
      signal::poles({1.0, body.denominator, body.denominator});
  for (std::complex<double>& pole : poles) {
    if (std::abs(pole) > 1.0) pole = 1.0 / std::conj(pole);
    // A hair inside, so that rounding doesn't put it out again.
    const double bound = bound_on(pole, body) - 1e-6;
    if (std::abs(pole) > bound) pole *= bound / std::abs(pole);
  }
  body.denominator = denominator_with(poles);
}

Eigen::VectorXd packed(const Model& model) {
  std::vector<double> all{model.body.offset};
  for (const auto& numerator : model.body.numerators) append(difference_basis(numerator), all);
  append(denominator_numbers(model.body.denominator), all);
  for (const Effect& effect : model.effects) {
    if (!effect.is_whole()) continue;
    append(effect.coefficients, all);
    for (const Parameter& parameter : effect.parameters) {
      if (parameter.fitted) all.push_back(parameter.value);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

void unpack(const Eigen::VectorXd& numbers, Model& model) {
  const double* next = numbers.data();
  const auto take = [&next](std::size_t count) {
    std::vector<double> values(next, next + count);
    next += count;
    return values;
  };
  model.body.offset = *next++;
  for (auto& numerator : model.body.numerators) {
    numerator = difference_basis(take(numerator.size()));
  }
  const auto tail = difference_basis(take(model.body.order()));
  std::ranges::copy(tail, model.body.denominator.begin() + 1);
  for (Effect& effect : model.effects) {
    if (!effect.is_whole()) continue;
    effect.coefficients = take(effect.coefficients.size());
    for (Parameter& parameter : effect.parameters) {
      if (parameter.fitted) {
        parameter.value = std::clamp(*next++, parameter.lower, parameter.upper);
      }
    }
  }
}

}  // namespace stillhand::diagnosis
