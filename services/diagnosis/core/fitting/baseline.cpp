// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/fitting/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "services/contract/config_error.hpp"
#include "services/diagnosis/core/fitting/modes.hpp"
#include "services/signal/decompositions.hpp"
#include "services/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kSteiglitzMcBrideSteps = 4;
constexpr double kClearlyAbove = 1.003;  // of what a long impulse response leaves

// Least squares by Householder QR, columns scaled.
Eigen::VectorXd least_squares(Eigen::MatrixXd columns, const Eigen::VectorXd& right) {
  const Eigen::VectorXd scale =
      columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  columns *= scale.asDiagonal();
  return scale.asDiagonal() * signal::least_squares(columns, right);
}

// A mode rings for a twenty-fourth of the record at most, what the input doesn't excite is
// forgotten within a sixtieth: a slower pole's free response would take a tone, or a drift, for
// itself.
void bound_poles(const Signals& signals, Body& body) {
  const auto radius = [&](double longest_s) {
    return std::exp(-1.0 / (longest_s * signals.rate_hz()));
  };
  body.largest_radius = radius(std::max(2.0, signals.duration_s() / 24.0));
  body.slowest_radius = radius(std::max(1.0, signals.duration_s() / 60.0));
  body.least_turn = 2.0 * std::numbers::pi * signals.lowest_excited_hz() / signals.rate_hz();
  stabilise(body);
}

// Rows of A(q) target = B(q) inputs + offset that don't reach beyond a stretch's start.
Body equation_error_fit(const std::vector<std::vector<double>>& inputs,
                        const std::vector<double>& target, const std::vector<bool>& valid,
                        const Signals& signals, std::size_t order) {
  const auto& stretches = signals.stretches();
  Columns columns{std::vector<double>(target.size(), 1.0)};
  for (const auto& input : inputs) {
    std::vector<double> x = input;
    for (std::size_t i = 0; i <= order; ++i) {
      if (i > 0) x = differenced(x, stretches);
      columns.push_back(x);
    }
  }
  std::vector<double> late = target;
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.end; n-- > stretch.first + 1;) late[n] = late[n - 1];
    late[stretch.first] = 0.0;
  }
  for (std::size_t i = 0; i < order; ++i) {
    if (i > 0) late = differenced(late, stretches);
    columns.push_back(late);
  }
  std::vector<std::size_t> rows;
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first + order; n < stretch.end; ++n) {
      if (valid[n] && valid[n - order] && signals.weight()[n] > 0.0) rows.push_back(n);
    }
  }
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows.size()),
                         static_cast<Eigen::Index>(columns.size()));
  Eigen::VectorXd right(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = columns[c][rows[r]];
    }
    right[static_cast<Eigen::Index>(r)] = target[rows[r]];
  }
  if (matrix.rows() < 2 * matrix.cols()) {
    throw ConfigError(
        "recording", std::to_string(rows.size()) + " usable samples",
        "at least " + std::to_string(2 * matrix.cols()) + " for order " + std::to_string(order));
  }
  const Eigen::VectorXd solution = least_squares(std::move(matrix), right);
  Body body;
  const double* next = solution.data() + 1;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    body.numerators.push_back(difference_basis({next, next + order + 1}));
    next += order + 1;
  }
  std::vector<double> g(next, next + order);
  for (double& each : g) each = -each;
  body.denominator.resize(1);
  const auto tail = difference_basis(g);
  body.denominator.insert(body.denominator.end(), tail.begin(), tail.end());
  bound_poles(signals, body);
  // sum of the denominator: what an offset before the poles becomes behind them.
  double sum = 0.0;
  for (const double a : body.denominator) sum += a;
  body.offset = order == 0 ? solution[0] : solution[0] / sum;
  return body;
}

struct Rated {
  Body body;
  double rmse = std::numeric_limits<double>::infinity();
};

// Numerators and offset refitted for the given poles; its free-run error.
Rated rated(const Body& start, const std::vector<std::vector<double>>& inputs,
            const std::vector<double>& output, const Signals& signals) {
  Rated result{start};
  const std::size_t order = start.order();
  const auto rows = static_cast<Eigen::Index>(output.size());
  const std::size_t taps = order + 1;
  Eigen::MatrixXd matrix(rows, static_cast<Eigen::Index>(1 + taps * inputs.size()));
  Eigen::Index column = 0;
  const auto write = [&](const std::vector<double>& x) {
    for (std::size_t n = 0; n < x.size(); ++n) {
      matrix(static_cast<Eigen::Index>(n), column) = x[n] * signals.weight()[n];
    }
    ++column;
  };
  write(std::vector<double>(output.size(), 1.0));
  for (const auto& input : inputs) {
    std::vector<double> x = through_poles(input, start.denominator, signals.stretches());
    for (std::size_t i = 0; i < taps; ++i) {
      if (i > 0) x = differenced(x, signals.stretches());
      write(x);
    }
  }
  Eigen::VectorXd right(rows);
  for (Eigen::Index n = 0; n < rows; ++n) {
    right[n] = output[static_cast<std::size_t>(n)] * signals.weight()[static_cast<std::size_t>(n)];
  }
  if (!matrix.allFinite()) return result;
  const InitialStates initial(start, signals, signals.weight());
  initial.remove_from(matrix);
  Eigen::Ref<Eigen::MatrixXd> view(right);
  initial.remove_from(view);
  const Eigen::VectorXd scale = matrix.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd normal =
      scale.asDiagonal() * (matrix.transpose() * matrix).eval() * scale.asDiagonal();
  normal.diagonal().array() += 1e-13;
  const Eigen::VectorXd solution =
      scale.asDiagonal() *
      signal::solve_symmetric(normal, scale.asDiagonal() * (matrix.transpose() * right));
  result.rmse = std::sqrt((right - matrix * solution).squaredNorm() / static_cast<double>(rows));
  result.body.offset = solution[0];
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const double* next = solution.data() + 1 + k * taps;
    result.body.numerators[k] = difference_basis({next, next + taps});
  }
  return result;
}

// Least squares with both sides filtered by the last denominator, again and again.
Rated steiglitz_mcbride(Body body, const std::vector<std::vector<double>>& inputs,
                        const std::vector<double>& output, const Signals& signals) {
  Rated best = rated(body, inputs, output, signals);
  const std::vector<bool> all(output.size(), true);
  for (int step = 0; step < kSteiglitzMcBrideSteps && body.order() > 0; ++step) {
    std::vector<std::vector<double>> filtered;
    for (const auto& input : inputs) {
      filtered.push_back(through_poles(input, body.denominator, signals.stretches()));
    }
    std::vector<double> centred = output;
    for (double& y : centred) y -= body.offset;
    body =
        equation_error_fit(filtered, through_poles(centred, body.denominator, signals.stretches()),
                           all, signals, body.order());
    Rated next = rated(body, inputs, output, signals);
    body = next.body;
    if (next.rmse < best.rmse) best = std::move(next);
  }
  return best;
}

std::vector<std::vector<double>> input_values(const Signals& signals) {
  std::vector<std::vector<double>> values;
  for (const Signal& input : signals.inputs()) values.push_back(input.values);
  return values;
}

Model empty_model(const Signals& signals) {
  Model model;
  model.rate_hz = signals.rate_hz();
  for (const Signal& input : signals.inputs()) model.inputs.push_back(input.name);
  model.output = signals.output().name;
  model.output_unit = signals.output().unit;
  return model;
}

// Whether the linearised cross-validation agrees with refitting: not where poles and zeros outside
// the excited band are free to move far without a change within it.
bool determined(const Model& model, const Signals& signals, const Blocks& blocks) {
  constexpr double kAgreement = 1.03;
  const Linearisation line = linearised(model, signals);
  const HeldOut linear =
      held_out_linearised(grams_of(line.jacobian, line.residual, line.run.weight, blocks), blocks);
  return linear.rmse() < kAgreement * held_out(model, signals, blocks).rmse();
}

}  // namespace

Body started_body(const std::vector<std::vector<double>>& inputs, const std::vector<double>& output,
                  const ImpulseResponse& impulse_response, const Signals& signals, int order) {
  const auto p = static_cast<std::size_t>(order);
  const std::vector<bool> all(output.size(), true);
  Rated best = steiglitz_mcbride(equation_error_fit(inputs, output, all, signals, p), inputs,
                                 output, signals);
  const auto usable = static_cast<std::size_t>(
      std::count(impulse_response.valid.begin(), impulse_response.valid.end(), true));
  if (order > 0 && usable > 20 * (p + 1) * (inputs.size() + 1)) {
    Rated other = steiglitz_mcbride(
        equation_error_fit(inputs, impulse_response.prediction, impulse_response.valid, signals, p),
        inputs, output, signals);
    if (other.rmse < best.rmse) best = std::move(other);
  }
  return best.body;
}

Body with_mode(const Body& like, const std::vector<double>& kept,
               const std::vector<std::vector<double>>& inputs, const std::vector<double>& output,
               const Signals& signals) {
  constexpr int kFrequencies = 12;
  constexpr double kHighestOfRate = 0.3;
  constexpr double kDampings[] = {0.1, 0.35};
  const double lowest_hz = 0.7 * signals.lowest_excited_hz();
  const double highest_hz = kHighestOfRate * signals.rate_hz();
  Body tried = like;
  for (auto& numerator : tried.numerators) numerator.resize(kept.size() + 2);
  Rated best{like};
  for (int i = 0; i < kFrequencies; ++i) {
    const double frequency_hz =
        lowest_hz * std::pow(highest_hz / lowest_hz, static_cast<double>(i) / (kFrequencies - 1));
    for (const double damping : kDampings) {
      tried.denominator = product(kept, mode_denominator(frequency_hz, damping, signals.rate_hz()));
      Rated next = rated(tried, inputs, output, signals);
      if (next.rmse < best.rmse) best = std::move(next);
    }
  }
  return best.body;
}

Body with_other_mode(const Body& fitted, const std::vector<std::vector<double>>& inputs,
                     const std::vector<double>& output, const Signals& signals) {
  Rated best = rated(fitted, inputs, output, signals);
  for (const std::complex<double>& pole :
       signal::poles({1.0, fitted.denominator, fitted.denominator})) {
    if (pole.imag() <= 0.0) continue;
    const std::vector<double> kept{1.0, -2.0 * pole.real(), std::norm(pole)};
    Rated next = rated(with_mode(fitted, kept, inputs, output, signals), inputs, output, signals);
    if (next.rmse < best.rmse) best = std::move(next);
  }
  return best.body;
}

Baseline fit_baseline(const Signals& signals, const Blocks& blocks, int order) {
  if (order < 0 || order > kLargestOrder) {
    throw ConfigError("order", std::to_string(order), "0 to " + std::to_string(kLargestOrder));
  }
  Baseline baseline;
  baseline.model = empty_model(signals);
  baseline.order = order;
  const auto inputs = input_values(signals);
  const ImpulseResponse impulse_response = fit_impulse_response(signals);
  baseline.impulse_response_rmse = impulse_response.rmse;
  const std::vector<bool> all(signals.size(), true);
  const Body paper = equation_error_fit(inputs, signals.output().values, all, signals,
                                        static_cast<std::size_t>(order));
  Model work = baseline.model;
  work.body = paper;
  FreeRun run;
  const auto rmse_of = [&](const Model& model) {
    return std::sqrt(residual_of(model, signals, run).squaredNorm() /
                     static_cast<double>(signals.size()));
  };
  baseline.equation_error_rmse = rmse_of(work);
  for (int p = order;; --p) {
    baseline.model.body =
        started_body(inputs, signals.output().values, impulse_response, signals, p);
    FitOptions options;
    options.max_iterations = 40;
    options.relative_tolerance = 1e-9;
    baseline.rmse = fit(baseline.model, signals, blocks, options).rmse;
    if (p == 4 && baseline.rmse > kClearlyAbove * impulse_response.rmse) {
      Model other = baseline.model;
      other.body = with_other_mode(other.body, inputs, signals.output().values, signals);
      const double rmse = fit(other, signals, blocks, options).rmse;
      if (rmse < baseline.rmse) {
        baseline.model = std::move(other);
        baseline.rmse = rmse;
      }
    }
    if (p <= 1 || determined(baseline.model, signals, blocks)) break;
  }
  return baseline;
}

}  // namespace stillhand::diagnosis
