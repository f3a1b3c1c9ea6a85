// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/model_run.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The state before sample n of a stretch.
VectorXd state_before(const Body& body, const std::vector<std::vector<double>>& inputs,
                      const std::vector<double>& output, std::size_t n) {
  const std::size_t p = body.order();
  VectorXd state = VectorXd::Zero(static_cast<Index>(p));
  for (std::size_t i = 1; i <= p; ++i) {
    for (std::size_t k = i; k <= p; ++k) {
      const std::size_t at = n - 1 - (k - i);
      double sum = -body.denominator[k] * output[at];
      for (std::size_t u = 0; u < inputs.size(); ++u) sum += body.numerators[u][k] * inputs[u][at];
      state[static_cast<Index>(i - 1)] += sum;
    }
  }
  return state;
}

// A root L of a positive semidefinite matrix, S = L L'.
MatrixXd root_of(const MatrixXd& s) {
  const auto [values, vectors] = signal::symmetric_eigenvectors(s);
  return vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// Of the residual r = M x + white noise, x of variance 1 times the square of a factor: the x for
// the factor with which r is most likely.
VectorXd most_likely(const MatrixXd& m, const VectorXd& r, double noise) {
  constexpr double kFactors[] = {1.0, 3.0, 10.0, 30.0};
  const auto [u, size, v] = signal::singular_vectors(m);
  const VectorXd seen = u.transpose() * r;
  double least = std::numeric_limits<double>::infinity();
  VectorXd gain = VectorXd::Zero(size.size());
  for (const double factor : kFactors) {
    const VectorXd variance = (factor * size).array().square() + noise * noise;
    const double unlikely =
        (variance.array().log() + seen.array().square() / variance.array()).sum();
    if (!(unlikely < least)) continue;
    least = unlikely;
    gain = factor * factor * size.cwiseQuotient(variance);
  }
  return v * gain.cwiseProduct(seen);
}

double square_at(const GivenRows& rows, const std::vector<double>& measured,
                 const std::vector<double>& predicted) {
  double sum = 0.0;
  for (const auto& stretch : rows) {
    for (const std::size_t n : stretch) sum += std::pow(measured[n] - predicted[n], 2);
  }
  return sum;
}

// The denominators of the state: the body's, then one an effect, without poles where it has none.
std::vector<std::vector<double>> denominators_of(const Model& model) {
  std::vector<std::vector<double>> all{model.body.denominator};
  for (const Effect& effect : model.effects) {
    all.push_back(effect_kind(effect.kind).own_poles(effect, model.rate_hz));
    if (all.back().empty()) all.back() = {1.0};
  }
  return all;
}

}  // namespace

MatrixXd state_spread(const Body& body, const std::vector<std::vector<double>>& inputs,
                      const std::vector<double>& output, const std::vector<Stretch>& stretches) {
  const auto p = static_cast<Index>(body.order());
  MatrixXd sum = MatrixXd::Zero(p, p);
  double count = 0.0;
  for (const Stretch& stretch : stretches) {
    const std::size_t from = stretch.first + body.order();
    if (from >= stretch.end) continue;
    const VectorXd first = state_before(body, inputs, output, from);
    for (std::size_t n = from; n < stretch.end; ++n) {
      const VectorXd moved = state_before(body, inputs, output, n) - first;
      sum += moved * moved.transpose();
      count += 1.0;
    }
  }
  return sum / std::max(count, 1.0);
}

std::size_t state_size(const Model& model) {
  std::size_t size = 0;
  for (const auto& denominator : denominators_of(model)) size += denominator.size() - 1;
  return size;
}

Signals started(const Model& model, const Signals& signals, const MatrixXd& states) {
  Columns columns;
  Index next = 0;
  for (const auto& denominator : denominators_of(model)) {
    const std::size_t poles = denominator.size() - 1;
    std::vector<double> e(poles > 0 || columns.empty() ? signals.size() : 0, 0.0);
    for (std::size_t s = 0; s < signals.stretches().size(); ++s) {
      const Stretch& stretch = signals.stretches()[s];
      for (std::size_t i = 0; i < std::min(stretch.end - stretch.first, poles); ++i) {
        e[stretch.first + i] = states(next + static_cast<Index>(i), static_cast<Index>(s));
      }
    }
    next += static_cast<Index>(poles);
    columns.push_back(std::move(e));
  }
  return signals.with_start(std::move(columns));
}

// What an effect's input adds to its own state from before the
// start is left out: it is small next to what a mode holds.
MatrixXd spread_of(const Model& model, const Signals& signals) {
  ModelRun run;
  const auto size = static_cast<Index>(state_size(model));
  run_all(model, started(model, signals, MatrixXd::Zero(size, std::ssize(signals.stretches()))),
          run);
  std::vector<std::vector<double>> inputs;
  for (const Signal& input : signals.inputs()) inputs.push_back(input.values);
  MatrixXd spread = MatrixXd::Zero(size, size);
  Index next = 0;
  const auto append = [&](const Body& body, const std::vector<std::vector<double>>& driven_by,
                          const std::vector<double>& output) {
    const auto p = static_cast<Index>(body.order());
    spread.block(next, next, p, p) = state_spread(body, driven_by, output, signals.stretches());
    next += p;
  };
  const auto denominators = denominators_of(model);
  append(model.body, inputs, run.free.body);
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    if (denominators[e + 1].size() > 1) append({{}, denominators[e + 1]}, {}, run.terms[e]);
  }
  return spread;
}

namespace {

// Gauss and Newton's steps.
class StartSteps {
 public:
  StartSteps(const Model& model, const Signals& signals, const MatrixXd& spread,
             const std::vector<double>& measured, const GivenRows& rows, double noise,
             const Answer& answer)
      : model_(model),
        signals_(signals),
        root_(root_of(spread)),
        measured_(measured),
        rows_(rows),
        noise_(noise),
        answer_(answer) {}

  [[nodiscard]] const MatrixXd& root() const { return root_; }
  [[nodiscard]] MatrixXd from(MatrixXd states) const;
  // [stretches] how unlikely, of the samples and the state: - 2 ln of both, up to a constant.
  [[nodiscard]] VectorXd unlikely(const MatrixXd& states) const {
    const std::vector<double> predicted = answer_(started(model_, signals_, states));
    VectorXd all(std::ssize(rows_));
    for (std::size_t s = 0; s < rows_.size(); ++s) {
      const auto column = static_cast<Index>(s);
      all[column] = square_at({rows_[s]}, measured_, predicted) / (noise_ * noise_) +
                    in_spreads(states.col(column)).squaredNorm();
    }
    return all;
  }

 private:
  [[nodiscard]] VectorXd in_spreads(const VectorXd& state) const {
    return root_.completeOrthogonalDecomposition().solve(state);
  }

  const Model& model_;
  const Signals& signals_;
  const MatrixXd root_;
  const std::vector<double>& measured_;
  const GivenRows& rows_;
  const double noise_;
  const Answer& answer_;
};

MatrixXd StartSteps::from(MatrixXd states) const {
  constexpr int kMostSteps = 5;
  constexpr double kStep = 1e-3;  // of a number's spread, for the derivative
  const Index size = root_.rows();
  std::vector<double> predicted = answer_(started(model_, signals_, states));
  for (int step = 0; step < kMostSteps; ++step) {
    std::vector<std::vector<double>> moved;
    for (Index j = 0; j < size; ++j) {
      MatrixXd other = states;
      other.colwise() += kStep * root_.col(j);
      moved.push_back(answer_(started(model_, signals_, other)));
    }
    MatrixXd next = states;
    for (std::size_t s = 0; s < rows_.size(); ++s) {
      const auto count = static_cast<Index>(rows_[s].size());
      if (count == 0) continue;
      const auto column = static_cast<Index>(s);
      MatrixXd slope(count, size);
      VectorXd residual(count);
      for (Index i = 0; i < count; ++i) {
        const std::size_t n = rows_[s][static_cast<std::size_t>(i)];
        residual[i] = measured_[n] - predicted[n];
        for (Index j = 0; j < size; ++j) {
          slope(i, j) = (moved[static_cast<std::size_t>(j)][n] - predicted[n]) / kStep;
        }
      }
      // About no state: the spread is that of the whole state, not of what it changes.
      const VectorXd present = in_spreads(states.col(column));
      next.col(column) = root_ * most_likely(slope, residual + slope * present, noise_);
    }
    std::vector<double> answered = answer_(started(model_, signals_, next));
    if (!(square_at(rows_, measured_, answered) < square_at(rows_, measured_, predicted))) break;
    states = std::move(next);
    predicted = std::move(answered);
  }
  return states;
}

// The measured output does not tell the sign of what is in front of its map.
bool loses_sign(const Model& model) {
  return std::ranges::any_of(model.effects, [](const Effect& effect) {
    const EffectKind& kind = effect_kind(effect.kind);
    return kind.stage(effect) == Stage::kOutputValue &&
           kind.slope(effect, 1.0) * kind.slope(effect, -1.0) < 0.0;
  });
}

}  // namespace

MatrixXd most_likely_start(const Model& model, const Signals& signals, const MatrixXd& spread,
                           const std::vector<double>& measured, const GivenRows& rows, double noise,
                           const Answer& answer) {
  constexpr int kTurns = 16;
  const Index size = spread.rows();
  MatrixXd states = MatrixXd::Zero(size, std::ssize(rows));
  if (size == 0) return states;
  const StartSteps steps(model, signals, spread, measured, rows, noise, answer);
  states = steps.from(states);
  if (!loses_sign(model)) return states;
  VectorXd least = steps.unlikely(states);
  // Around the ellipse of the two largest directions.
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = 2.0 * std::numbers::pi * turn / kTurns;
    VectorXd begin = std::cos(angle) * steps.root().col(size - 1);
    if (size > 1) begin += std::sin(angle) * steps.root().col(size - 2);
    const MatrixXd other = steps.from(begin.replicate(1, std::ssize(rows)));
    const VectorXd unlikely = steps.unlikely(other);
    for (Index s = 0; s < least.size(); ++s) {
      if (!(unlikely[s] < least[s])) continue;
      least[s] = unlikely[s];
      states.col(s) = other.col(s);
    }
  }
  return states;
}

}  // namespace stillhand::diagnosis
