// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/shape_exchange.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"
#include "services/core/diagnosis/model/modes.hpp"

namespace stillhand::diagnosis {
namespace {

using Polynomial = std::vector<double>;  // by powers of q^-1

// The first `terms` of a / b as a series in q^-1: the quotient, where b divides a.
Polynomial quotient(Polynomial a, const Polynomial& b, std::size_t terms) {
  a.resize(std::max(a.size(), terms + b.size()), 0.0);
  Polynomial result(terms);
  for (std::size_t i = 0; i < terms; ++i) {
    result[i] = a[i] / b[0];
    for (std::size_t j = 0; j < b.size(); ++j) a[i + j] -= result[i] * b[j];
  }
  return result;
}

Polynomial sum(const Polynomial& a, double factor, const Polynomial& b) {
  Polynomial result(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] += a[i];
  for (std::size_t i = 0; i < b.size(); ++i) result[i] += factor * b[i];
  return result;
}

std::vector<double> shaped(const Effect& effect, const std::vector<double>& z, double scale,
                           const Signals& signals) {
  const Nonlinearity nonlinearity = effect_kind(effect.kind).feedback(effect);
  std::vector<double> phi(z.size());
  for (const Stretch& stretch : signals.stretches()) {
    LoopMemory memory;
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      phi[n] = nonlinearity.phi(z[n] / (scale * nonlinearity.threshold), memory);
    }
  }
  return phi;
}

// phi(z) ~ alpha psi(z / beta) + gamma z + level
struct Match {
  double alpha = 0.0;
  double beta = 1.0;
  double gamma = 0.0;
  double level = 0.0;
  double left = std::numeric_limits<double>::infinity();  // root of the sum of squares
};

Eigen::Map<const Eigen::VectorXd> column(const std::vector<double>& x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

// @param columns  z, then a constant where there is to be a level; room for psi in front of them
Match matched(const std::vector<double>& phi, const Effect& other, const std::vector<double>& z,
              std::span<const double> scales, Eigen::MatrixXd columns, const Signals& signals) {
  Match best;
  for (const double beta : scales) {
    columns.col(0) = column(shaped(other, z, beta, signals));
    const Eigen::VectorXd factors = columns.colPivHouseholderQr().solve(column(phi));
    const double left = (column(phi) - columns * factors).norm();
    if (left < best.left) {
      best = {factors[0], beta, factors[1], factors.size() > 2 ? factors[2] : 0.0, left};
    }
  }
  return best;
}

// The model with `other` in place of its last effect, as it was matched.
std::optional<Model> exchanged(const Model& model, const Effect& other, const Match& match,
                               const Signals& signals) {
  const std::size_t order = model.body.order();
  const LoopPath own = loop_path(model.effects.back(), order);
  Model result = model;
  const Polynomial& a = model.body.denominator;
  const auto gain = [](const Polynomial& c) { return std::accumulate(c.begin(), c.end(), 0.0); };
  result.body.offset += match.level * gain(own.e) / gain(a);
  result.body.denominator = sum(a, -match.gamma, own.m);
  Polynomial& b = result.body.numerators.front();
  b = quotient(sum(product(b, result.body.denominator), match.gamma, product(own.e, own.n)), a,
               order + 1);
  LoopPath path = own;
  for (double& each : path.e) each *= match.alpha;
  for (double& each : path.n) each /= match.beta;
  for (double& each : path.m) each *= match.alpha / match.beta;
  result.effects.back() = other;
  result.effects.back().coefficients = coefficients_of(path);
  if (!is_stable(result.body)) stabilise(result.body);
  if (!free_run(result, signals).finite) return std::nullopt;
  return result;
}

}  // namespace

std::vector<double> coefficients_of(const LoopPath& path) {
  std::vector<double> all = difference_basis(path.e);
  const auto append = [&all](const std::vector<double>& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  append(difference_basis(path.n));
  append(difference_basis({path.m.begin() + 1, path.m.end()}));
  return all;
}

bool ends_inside_body(const Model& model) {
  return !model.effects.empty() && acts_at(model.effects.back(), Stage::kFeedback) &&
         !loop_path(model.effects.back(), model.body.order()).of_output();
}

Model lifted(const Model& model) {
  constexpr double kPole = 0.5;  // faster than anything that the input excites
  const Polynomial factor{1.0, -kPole};
  Model result = model;
  Effect& effect = result.effects.back();
  LoopPath path = loop_path(effect, model.body.order());
  for (Polynomial* each : {&path.e, &path.n, &path.m}) *each = product(*each, factor);
  effect.coefficients = coefficients_of(path);
  result.body.denominator = product(model.body.denominator, factor);
  for (Polynomial& each : result.body.numerators) each = product(each, factor);
  return result;
}

std::optional<Model> with_shape_of(const Effect& other, const Model& model,
                                   const Signals& signals) {
  constexpr std::array kScales{0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0};
  const FreeRun run = free_run(model, signals);
  if (!run.finite) return std::nullopt;
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(signals.size()), 2);
  columns.col(1) = column(run.argument);
  const Match match = matched(shaped(model.effects.back(), run.argument, 1.0, signals), other,
                              run.argument, kScales, std::move(columns), signals);
  return exchanged(model, other, match, signals);
}

Reading read_as(const Effect& law, const Model& curve, const Signals& signals) {
  constexpr int kScales = 29;  // from 1.2^-14 to 1.2^14
  const FreeRun run = free_run(curve, signals);
  if (!run.finite) return {};
  const std::vector<double> phi = shaped(curve.effects.back(), run.argument, 1.0, signals);
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(signals.size()), 3);
  columns.col(1) = column(run.argument);
  columns.col(2).setOnes();
  const auto straight = columns.rightCols(2);
  const double bend =
      (column(phi) - straight * straight.colPivHouseholderQr().solve(column(phi))).norm();
  if (!(bend > 0.0)) return {};
  std::vector<double> scales;
  for (int i = 0; i < kScales; ++i) scales.push_back(std::pow(1.2, i - kScales / 2));
  const Match match = matched(phi, law, run.argument, scales, std::move(columns), signals);
  return {match.left / bend, exchanged(curve, law, match, signals)};
}

}  // namespace stillhand::diagnosis
