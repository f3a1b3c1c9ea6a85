// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/equation_error.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kUsualPart = 24.0;   // record over the longest ringing
constexpr double kSlowPart = 2.0;     // likewise, Eq. DG-66
constexpr double kIntegrator = 10.0;  // decay over the record: it holds what it was given

// Least squares by Householder QR, columns scaled.
Eigen::VectorXd least_squares(Eigen::MatrixXd columns, const Eigen::VectorXd& right) {
  const Eigen::VectorXd scale =
      columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  columns *= scale.asDiagonal();
  return scale.asDiagonal() * signal::least_squares(columns, right);
}

// A mode rings for a twenty-fourth of the record at most; what the input does not excite is
// forgotten within a sixtieth.  The free response of a slower pole would fit a tone or a drift.
// Where the output asks for it, Eq. DG-66, a mode may ring for half of the record, and a level may
// stay for all of it.
void bound_poles(const Signals& signals, Body& body) {
  const auto radius = [&](double longest_s) {
    return std::exp(-1.0 / (longest_s * signals.rate_hz()));
  };
  const double longest_s = signals.duration_s();
  const bool slow = signals.slow_poles();
  body.largest_radius = radius(std::max(2.0, longest_s / (slow ? kSlowPart : kUsualPart)));
  body.slowest_radius = radius(slow ? kIntegrator * longest_s : std::max(1.0, longest_s / 60.0));
  body.least_turn = 2.0 * std::numbers::pi * signals.lowest_excited_hz() / signals.rate_hz();
  stabilise(body);
}

// The offset, each input's differences of order 0 to p, and the differences of the delayed target.
Columns regressors(const std::vector<std::vector<double>>& inputs,
                   const std::vector<double>& target, const std::vector<Stretch>& stretches,
                   std::size_t order) {
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
  return columns;
}

// Samples that count and do not reach back beyond their stretch's start.
std::vector<std::size_t> usable_rows(const std::vector<bool>& valid, const Signals& signals,
                                     std::size_t order) {
  std::vector<std::size_t> rows;
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first + order; n < stretch.end; ++n) {
      if (valid[n] && valid[n - order] && signals.weight()[n] > 0.0) rows.push_back(n);
    }
  }
  return rows;
}

// The solution's differences as a body's polynomials, without its offset.
Body body_of(const Eigen::VectorXd& solution, std::size_t inputs, std::size_t order) {
  Body body;
  const double* next = solution.data() + 1;
  for (std::size_t k = 0; k < inputs; ++k) {
    body.numerators.push_back(difference_basis({next, next + order + 1}));
    next += order + 1;
  }
  std::vector<double> g(next, next + order);
  for (double& each : g) each = -each;
  body.denominator.resize(1);
  const auto tail = difference_basis(g);
  body.denominator.insert(body.denominator.end(), tail.begin(), tail.end());
  return body;
}

}  // namespace

Body equation_error_fit(const std::vector<std::vector<double>>& inputs,
                        const std::vector<double>& target, const std::vector<bool>& valid,
                        const Signals& signals, std::size_t order) {
  const Columns columns = regressors(inputs, target, signals.stretches(), order);
  const std::vector<std::size_t> rows = usable_rows(valid, signals, order);
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
  Body body = body_of(solution, inputs.size(), order);
  bound_poles(signals, body);
  // An offset before the poles becomes offset / (sum of the denominator) behind them.
  double sum = 0.0;
  for (const double a : body.denominator) sum += a;
  body.offset = order == 0 ? solution[0] : solution[0] / sum;
  return body;
}

}  // namespace stillhand::diagnosis
