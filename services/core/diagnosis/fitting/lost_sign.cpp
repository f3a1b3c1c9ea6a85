// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/lost_sign.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFunctions = 10;  // shared by the inputs
constexpr int kPoles = 6;               // over the excited band
constexpr double kRidge = 1e-3;         // of the mean power of the products
constexpr int kMostTurns = 30;

// x/(1 - a q^-1), then by turns (q^-1 - a)/(1 - a q^-1), each stretch from rest.
void append_laguerre(std::vector<double> x, double pole, std::size_t count, const Signals& signals,
                     MatrixXd& columns, Index& next) {
  for (std::size_t k = 0; k < count; ++k, ++next) {
    for (const Stretch& stretch : signals.stretches()) {
      double state = 0.0;
      double before = 0.0;
      for (std::size_t n = stretch.first; n < stretch.end; ++n) {
        state = pole * state + (k == 0 ? x[n] : before - pole * x[n]);
        before = x[n];
        x[n] = state;
      }
    }
    columns.col(next) = Eigen::Map<const VectorXd>(x.data(), std::ssize(x));
  }
}

// Weighted, each of unit power, the last one constant.
MatrixXd functions_of(const Signals& signals, double pole, const VectorXd& weight) {
  const std::size_t each = std::max<std::size_t>(kFunctions / signals.inputs().size(), 3);
  MatrixXd columns(weight.size(), static_cast<Index>(each * signals.inputs().size()) + 1);
  Index next = 0;
  for (const Signal& input : signals.inputs()) {
    append_laguerre(input.values, pole, each, signals, columns, next);
  }
  columns.col(next).setOnes();
  for (Index i = 0; i < columns.cols(); ++i) {
    columns.col(i).array() *= weight.array();
    columns.col(i) /= std::max(columns.col(i).norm(), 1e-300);
  }
  return columns;
}

// h from the square, which is linear in the products of the functions.
VectorXd from_square(const MatrixXd& x, const VectorXd& y) {
  const Index m = x.cols();
  MatrixXd products(x.rows(), m * (m + 1) / 2);
  Index next = 0;
  for (Index i = 0; i < m; ++i) {
    for (Index j = i; j < m; ++j) {
      products.col(next++) = (i == j ? 1.0 : 2.0) * x.col(i).cwiseProduct(x.col(j));
    }
  }
  MatrixXd normal = products.transpose() * products;
  normal.diagonal().array() += kRidge * normal.trace() / static_cast<double>(normal.rows());
  const VectorXd factors = signal::solve_symmetric(normal, products.transpose() * y.cwiseAbs2());
  MatrixXd square(m, m);
  next = 0;
  for (Index i = 0; i < m; ++i) {
    for (Index j = i; j < m; ++j) square(i, j) = square(j, i) = factors[next++];
  }
  return signal::symmetric_eigenvectors(square).vectors.col(m - 1);
}

VectorXd signed_by(const VectorXd& response, const VectorXd& y) {
  return y.binaryExpr(response, [](double size, double v) { return std::copysign(size, v); });
}

}  // namespace

std::vector<double> with_lost_sign(const Signals& signals) {
  const VectorXd weight =
      Eigen::Map<const VectorXd>(signals.weight().data(), std::ssize(signals.weight()));
  const VectorXd measured = Eigen::Map<const VectorXd>(signals.output().values.data(),
                                                       std::ssize(signals.output().values));
  const VectorXd y = measured.cwiseProduct(weight);
  const double octaves = std::log2(signals.highest_excited_hz() / signals.lowest_excited_hz());
  double least = std::numeric_limits<double>::infinity();
  VectorXd best = measured;
  for (int i = 0; i < kPoles; ++i) {
    const double corner_hz = signals.lowest_excited_hz() * std::exp2(octaves * (i + 0.5) / kPoles);
    const double pole = std::exp(-2.0 * std::numbers::pi * corner_hz / signals.rate_hz());
    const MatrixXd x = functions_of(signals, pole, weight);
    VectorXd response = x * from_square(x, y);
    for (int turn = 0; turn < kMostTurns; ++turn) {
      const VectorXd wanted = signed_by(response, y);
      response = x * signal::solve_symmetric(x.transpose() * x, x.transpose() * wanted);
      if (signed_by(response, y) == wanted) break;
    }
    const double left = (response.cwiseAbs() - y).squaredNorm();
    if (left < least) {
      least = left;
      best = signed_by(response, measured);
    }
  }
  return {best.begin(), best.end()};
}

}  // namespace stillhand::diagnosis
