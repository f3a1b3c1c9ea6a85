// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/baseline.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/fitting/equation_error.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/diagnosis/record/wide_sums.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kSteiglitzMcBrideSteps = 4;
constexpr double kSettled = 1e-4;        // of the error: no further step
constexpr double kClearlyAbove = 1.003;  // of what a long impulse response leaves

struct Rated {
  Body body;
  double rmse = std::numeric_limits<double>::infinity();
};

// x(n) - x(n-1), every stretch from rest.
void difference_in_place(std::vector<double>& x, const std::vector<Stretch>& stretches) {
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.end; n-- > stretch.first + 1;) x[n] -= x[n - 1];
  }
}

// Products of all the columns.
Eigen::MatrixXd products_of(const Eigen::MatrixXd& columns) {
  constexpr Eigen::Index kRows = 512;  // at a time: they stay in the processor's first cache
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  Eigen::MatrixXd part = sum;
  for (Eigen::Index first = 0; first < columns.rows(); first += kRows) {
    ColumnPointers pointers;
    append_columns(columns, first, pointers);
    const Eigen::Index rows = std::min(kRows, columns.rows() - first);
    write_products(pointers, static_cast<std::size_t>(rows), 0, part);
    sum += part;
  }
  return sum;
}

// Columns of a body's linear numbers, then the output: weighted, without initial states, whitened.
Eigen::MatrixXd linear_columns(const Body& body, const std::vector<std::vector<double>>& inputs,
                               const std::vector<double>& output, const Signals& signals) {
  const std::size_t taps = body.order() + 1;
  const std::vector<double>& weight = signals.weight();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(output.size()),
                          static_cast<Eigen::Index>(2 + taps * inputs.size()));
  Eigen::Index column = 0;
  const auto write = [&](const std::vector<double>& x) {
    double* const to = columns.col(column++).data();
    for (std::size_t n = 0; n < x.size(); ++n) to[n] = x[n] * weight[n];
  };
  write(std::vector<double>(output.size(), 1.0));
  for (const auto& input : inputs) {
    std::vector<double> x = through_poles(input, body.denominator, signals.stretches());
    for (std::size_t i = 0; i < taps; ++i) {
      if (i > 0) difference_in_place(x, signals.stretches());
      write(x);
    }
  }
  write(output);
  if (!columns.allFinite()) return {};
  InitialStates(body, signals, weight).remove_from(columns);
  signals.whiten(columns, weight);
  return columns;
}

// |last column - others solution|^2 from the products; where these cancel, from the columns.
double left_square(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& products,
                   const Eigen::VectorXd& solution) {
  constexpr double kCancels = 1e-8;
  const Eigen::Index numbers = solution.size();
  const double whole = products(numbers, numbers);
  const double left = whole - 2.0 * solution.dot(products.col(numbers).head(numbers)) +
                      solution.dot(products.topLeftCorner(numbers, numbers) * solution);
  if (left > kCancels * whole) return left;
  return (columns.col(numbers) - columns.leftCols(numbers) * solution).squaredNorm();
}

// Numerators and offset refitted for the given poles; its free-run error.
Rated rated(const Body& start, const std::vector<std::vector<double>>& inputs,
            const std::vector<double>& output, const Signals& signals) {
  Rated result{start};
  const Eigen::MatrixXd columns = linear_columns(start, inputs, output, signals);
  if (columns.size() == 0) return result;
  const Eigen::MatrixXd products = products_of(columns);
  const Eigen::Index numbers = columns.cols() - 1;
  const Eigen::VectorXd scale =
      products.diagonal().head(numbers).cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd normal =
      scale.asDiagonal() * products.topLeftCorner(numbers, numbers) * scale.asDiagonal();
  normal.diagonal().array() += 1e-13;
  const Eigen::VectorXd solution =
      scale.asDiagonal() *
      signal::solve_symmetric(normal, scale.asDiagonal() * products.col(numbers).head(numbers));
  result.rmse =
      std::sqrt(left_square(columns, products, solution) / static_cast<double>(columns.rows()));
  result.body.offset = solution[0];
  const std::size_t taps = start.order() + 1;
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
    const bool settled = std::abs(next.rmse - best.rmse) < kSettled * best.rmse;
    if (next.rmse < best.rmse) best = std::move(next);
    if (settled) break;
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

double linearised_rmse(const Model& model, const Signals& signals, const Blocks& blocks) {
  const Linearisation line = linearised(model, signals);
  return held_out_linearised(grams_of(line.jacobian, line.residual, line.run.weight, blocks),
                             blocks)
      .rmse();
}

// Whether the linearised cross-validation agrees with refitting: not where poles and zeros outside
// the excited band are free to move far without a change within it.
bool determined(const Model& model, const Signals& signals, const Blocks& blocks) {
  constexpr double kAgreement = 1.03;
  return linearised_rmse(model, signals, blocks) <
         kAgreement * held_out(model, signals, blocks).rmse();
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

Body refined_body(const Body& start, const std::vector<std::vector<double>>& inputs,
                  const std::vector<double>& output, const Signals& signals) {
  return steiglitz_mcbride(start, inputs, output, signals).body;
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

namespace {

// Of one order, by DG-9 from the best start.
void fit_order(const ImpulseResponse& impulse_response, const Signals& signals,
               const Blocks& blocks, int order, Baseline& baseline) {
  const auto inputs = input_values(signals);
  const std::vector<double>& output = signals.output().values;
  FitOptions options;
  options.max_iterations = 40;
  options.relative_tolerance = 1e-9;
  baseline.model.body = started_body(inputs, output, impulse_response, signals, order);
  baseline.rmse = fit(baseline.model, signals, blocks, options).rmse;
  // Behind a filter the impulse response, which is fitted without it, is no bound.
  const bool may_be_local =
      signals.is_whitened() || baseline.rmse > kClearlyAbove * impulse_response.rmse;
  if (order != 4 || !may_be_local) return;
  Model other = baseline.model;
  other.body = with_other_mode(other.body, inputs, output, signals);
  const double rmse = fit(other, signals, blocks, options).rmse;
  if (rmse < baseline.rmse) {
    baseline.model = std::move(other);
    baseline.rmse = rmse;
  }
}

}  // namespace

Baseline fit_baseline(const Signals& signals, const Blocks& blocks, int order) {
  if (order < 0 || order > kLargestOrder) {
    throw ConfigError("order", std::to_string(order), "0 to " + std::to_string(kLargestOrder));
  }
  Baseline baseline;
  baseline.model = empty_model(signals);
  baseline.order = order;
  const ImpulseResponse impulse_response = fit_impulse_response(signals);
  baseline.impulse_response_rmse = impulse_response.rmse;
  Model work = baseline.model;
  work.body = equation_error_fit(input_values(signals), signals.output().values,
                                 std::vector<bool>(signals.size(), true), signals,
                                 static_cast<std::size_t>(order));
  FreeRun run;
  baseline.equation_error_rmse = std::sqrt(residual_of(work, signals, run).squaredNorm() /
                                           static_cast<double>(signals.size()));
  fit_order(impulse_response, signals, blocks, order, baseline);
  // A slow body's order is chosen by how it goes on from a start state, Eq. DG-66.
  if (signals.slow_poles()) return baseline;
  for (int p = order; p > 1 && !determined(baseline.model, signals, blocks); --p) {
    fit_order(impulse_response, signals, blocks, p - 1, baseline);
  }
  if (radii_on_bound(baseline.model).empty()) return baseline;
  // Next to a pole that its bound holds back, more poles may explain less.
  double least = held_out(baseline.model, signals, blocks).rmse();
  Baseline lower = baseline;
  for (int p = static_cast<int>(baseline.model.body.order()); p > 1; --p) {
    fit_order(impulse_response, signals, blocks, p - 1, lower);
    const double rmse = held_out(lower.model, signals, blocks).rmse();
    if (!(rmse < least)) continue;
    least = rmse;
    baseline = lower;
  }
  return baseline;
}

}  // namespace stillhand::diagnosis
