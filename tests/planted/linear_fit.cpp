// SPDX-License-Identifier: Apache-2.0
#include "planted/linear_fit.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>

namespace stillhand::planted {

Series beyond_impulse_response(const Series& input, const Series& output, std::size_t taps,
                               std::size_t stride) {
  const std::size_t first = taps * stride;
  if (output.size() <= first + (taps + 1) * stride) return {};
  const auto order = static_cast<Eigen::Index>(taps + 1);  // the last unknown is the constant
  const auto row = [&](std::size_t n) {
    Eigen::VectorXd out(order);
    for (std::size_t i = 0; i < taps; ++i) {
      out[static_cast<Eigen::Index>(i)] = input[n - i * stride];
    }
    out[order - 1] = 1.0;
    return out;
  };
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(order, order);
  Eigen::VectorXd moment = Eigen::VectorXd::Zero(order);
  constexpr std::size_t kBlock = 512;
  const std::size_t total = (output.size() - first) / stride;  // rows as sparse as the taps
  for (std::size_t from = 0; from < total; from += kBlock) {
    const std::size_t count = std::min(kBlock, total - from);
    Eigen::MatrixXd rows(order, static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t n = first + (from + k) * stride;
      rows.col(static_cast<Eigen::Index>(k)) = row(n);
      moment += output[n] * rows.col(static_cast<Eigen::Index>(k));
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  }
  // A band-limited input leaves most directions empty; 1e-9 of the largest keeps the solution
  // bounded there and moves the residual by less than 1e-4 of the output.
  normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff();
  const Eigen::VectorXd weights = normal.selfadjointView<Eigen::Lower>().ldlt().solve(moment);
  Series out(total);
  for (std::size_t k = 0; k < total; ++k) {
    const std::size_t n = first + k * stride;
    out[k] = output[n] - weights.dot(row(n));
  }
  return out;
}

namespace {

/// y(n) = x(n) - sum_j d_j y(n-j), from rest.
Series through_poles(const Series& x, const Eigen::VectorXd& poles) {
  Series y(x.size());
  for (std::size_t n = 0; n < x.size(); ++n) {
    double sum = x[n];
    for (std::size_t j = 1; j <= static_cast<std::size_t>(poles.size()) && j <= n; ++j) {
      sum -= poles[static_cast<Eigen::Index>(j - 1)] * y[n - j];
    }
    y[n] = sum;
  }
  return y;
}

/// The same polynomial z^order + sum_j d_j z^(order-j) with every root that forgets too slowly, or
/// grows, moved inwards to `radius`.
Eigen::VectorXd forgetting(const Eigen::VectorXd& poles, double radius) {
  const auto order = poles.size();
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  companion.row(0) = -poles.transpose();
  for (Eigen::Index i = 1; i < order; ++i) companion(i, i - 1) = 1.0;
  Eigen::VectorXcd polynomial = Eigen::VectorXcd::Zero(order + 1);
  polynomial[0] = 1.0;
  for (const std::complex<double>& root : Eigen::VectorXcd(companion.eigenvalues())) {
    const std::complex<double> inside =
        std::abs(root) < radius ? root : root * (radius / std::abs(root));
    for (Eigen::Index i = order; i > 0; --i) polynomial[i] -= inside * polynomial[i - 1];
  }
  return polynomial.tail(order).real();
}

/// Columns: 1/A of the input delayed by 0 .. order, and a constant; the first `skip` rows left out.
Eigen::MatrixXd numerator_columns(const Series& input, const Eigen::VectorXd& poles,
                                  std::size_t skip) {
  const auto order = poles.size();
  const auto count = static_cast<Eigen::Index>(input.size() - skip);
  const Series x = through_poles(input, poles);
  Eigen::MatrixXd out(count, order + 2);
  for (Eigen::Index i = 0; i <= order; ++i) {
    out.col(i) = Eigen::Map<const Eigen::VectorXd>(x.data() + skip - i, count);
  }
  out.col(order + 1).setOnes();
  return out;
}

}  // namespace

double left_by_difference_equation(const Series& input, const Series& output, std::size_t order,
                                   std::size_t skip, double longest_samples) {
  if (skip < order || output.size() < skip + 10 * order) return std::nan("");
  const auto count = static_cast<Eigen::Index>(output.size() - skip);
  const auto poles_count = static_cast<Eigen::Index>(order);
  const Eigen::Map<const Eigen::VectorXd> wanted(output.data() + skip, count);
  Eigen::VectorXd poles = Eigen::VectorXd::Zero(poles_count);
  const double radius = std::exp(-1.0 / longest_samples);
  double best = INFINITY;
  constexpr int kPasses = 25;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::MatrixXd numerator = numerator_columns(input, poles, skip);
    if (pass > 0) {
      const Eigen::VectorXd weights = numerator.colPivHouseholderQr().solve(wanted);
      best = std::min(best, std::sqrt((wanted - numerator * weights).squaredNorm() /
                                      static_cast<double>(count)));
    }
    const Series filtered = through_poles(output, poles);
    Eigen::MatrixXd columns(count, numerator.cols() + poles_count);
    columns.leftCols(numerator.cols()) = numerator;
    for (Eigen::Index j = 1; j <= poles_count; ++j) {
      columns.col(numerator.cols() + j - 1) =
          -Eigen::Map<const Eigen::VectorXd>(filtered.data() + skip - j, count);
    }
    const Eigen::Map<const Eigen::VectorXd> target(filtered.data() + skip, count);
    poles = forgetting(
        Eigen::VectorXd(columns.colPivHouseholderQr().solve(target)).tail(poles_count), radius);
  }
  return best;
}

}  // namespace stillhand::planted
