// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/start_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillhand::predict {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The state before sample n of a stretch.
VectorXd state_before(const diagnosis::Body& body, const std::vector<std::vector<double>>& inputs,
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
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(s);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// Of the residual r = M x + white noise, x of variance 1 times the square of a factor: the x for
// the factor with which r is most likely.
VectorXd most_likely(const MatrixXd& m, const VectorXd& r, double noise) {
  constexpr double kFactors[] = {1.0, 3.0, 10.0, 30.0};
  const Eigen::JacobiSVD<MatrixXd> svd(m, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& size = svd.singularValues();
  const VectorXd seen = svd.matrixU().transpose() * r;
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
  return svd.matrixV() * gain.cwiseProduct(seen);
}

double square_at(const std::vector<std::vector<std::size_t>>& rows,
                 const std::vector<double>& measured, const std::vector<double>& predicted) {
  double sum = 0.0;
  for (const auto& stretch : rows) {
    for (const std::size_t n : stretch) sum += std::pow(measured[n] - predicted[n], 2);
  }
  return sum;
}

}  // namespace

MatrixXd state_spread(const diagnosis::Body& body, const std::vector<std::vector<double>>& inputs,
                      const std::vector<double>& output,
                      const std::vector<diagnosis::Stretch>& stretches) {
  const auto p = static_cast<Index>(body.order());
  MatrixXd sum = MatrixXd::Zero(p, p);
  double count = 0.0;
  for (const diagnosis::Stretch& stretch : stretches) {
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

StartStates most_likely_start(const std::vector<double>& measured,
                              const std::vector<std::vector<std::size_t>>& rows,
                              const MatrixXd& spread, double noise, const Answer& answer) {
  constexpr int kMostSteps = 5;
  constexpr double kStep = 1e-3;  // of a number's spread, for the derivative
  const Index p = spread.rows();
  StartStates states = StartStates::Zero(p, static_cast<Index>(rows.size()));
  const MatrixXd root = root_of(spread);
  std::vector<double> predicted = answer(states);
  for (int step = 0; step < kMostSteps; ++step) {
    std::vector<std::vector<double>> moved;
    for (Index j = 0; j < p; ++j) {
      StartStates other = states;
      other.colwise() += kStep * root.col(j);
      moved.push_back(answer(other));
    }
    StartStates next = states;
    for (std::size_t s = 0; s < rows.size(); ++s) {
      const auto count = static_cast<Index>(rows[s].size());
      if (count == 0) continue;
      const auto column = static_cast<Index>(s);
      MatrixXd slope(count, p);
      VectorXd residual(count);
      for (Index i = 0; i < count; ++i) {
        const std::size_t n = rows[s][static_cast<std::size_t>(i)];
        residual[i] = measured[n] - predicted[n];
        for (Index j = 0; j < p; ++j) {
          slope(i, j) = (moved[static_cast<std::size_t>(j)][n] - predicted[n]) / kStep;
        }
      }
      // About no state: the spread is that of the whole state, not of what it changes.
      const VectorXd present = root.completeOrthogonalDecomposition().solve(states.col(column));
      next.col(column) = root * most_likely(slope, residual + slope * present, noise);
    }
    std::vector<double> answered = answer(next);
    if (!(square_at(rows, measured, answered) < square_at(rows, measured, predicted))) break;
    states = next;
    predicted = std::move(answered);
  }
  return states;
}

}  // namespace stillhand::predict
