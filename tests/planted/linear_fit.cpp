// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/linear_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

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

/// Columns: 1/A of the input delayed by 0 .. order, a constant, and the free responses to what was
/// before the record; the first `skip` rows left out.
Eigen::MatrixXd numerator_columns(const Series& input, const Eigen::VectorXd& poles,
                                  std::size_t skip) {
  const auto order = poles.size();
  const auto count = static_cast<Eigen::Index>(input.size() - skip);
  const Series x = through_poles(input, poles);
  Series impulse(input.size(), 0.0);
  impulse.front() = 1.0;
  const Series free = through_poles(impulse, poles);
  Eigen::MatrixXd out(count, 2 * order + 2);
  for (Eigen::Index i = 0; i <= order; ++i) {
    out.col(i) = Eigen::Map<const Eigen::VectorXd>(x.data() + skip - i, count);
  }
  out.col(order + 1).setOnes();
  for (Eigen::Index j = 0; j < order; ++j) {
    out.col(order + 2 + j) =
        Eigen::Map<const Eigen::VectorXd>(free.data() + static_cast<Eigen::Index>(skip) - j, count);
  }
  return out;
}

/// What these poles leave at best, and the poles of the next pass after Steiglitz and McBride.
class Passes {
 public:
  Passes(const Series& input, const Series& output, std::size_t skip, double longest_samples)
      : input_(input),
        output_(output),
        skip_(skip),
        radius_(std::exp(-1.0 / longest_samples)),
        wanted_(output.data() + skip, static_cast<Eigen::Index>(output.size() - skip)) {}

  [[nodiscard]] double left(const Eigen::VectorXd& poles) const {
    const Eigen::MatrixXd numerator = numerator_columns(input_, poles, skip_);
    const Eigen::VectorXd weights = numerator.colPivHouseholderQr().solve(wanted_);
    return std::sqrt((wanted_ - numerator * weights).squaredNorm() /
                     static_cast<double>(wanted_.size()));
  }

  [[nodiscard]] Eigen::VectorXd next(const Eigen::VectorXd& poles) const {
    const Eigen::MatrixXd numerator = numerator_columns(input_, poles, skip_);
    const Series filtered = through_poles(output_, poles);
    Eigen::MatrixXd columns(wanted_.size(), numerator.cols() + poles.size());
    columns.leftCols(numerator.cols()) = numerator;
    for (Eigen::Index j = 1; j <= poles.size(); ++j) {
      columns.col(numerator.cols() + j - 1) = -Eigen::Map<const Eigen::VectorXd>(
          filtered.data() + static_cast<Eigen::Index>(skip_) - j, wanted_.size());
    }
    const Eigen::Map<const Eigen::VectorXd> target(filtered.data() + skip_, wanted_.size());
    return forgetting(
        Eigen::VectorXd(columns.colPivHouseholderQr().solve(target)).tail(poles.size()), radius_);
  }

 private:
  const Series& input_;
  const Series& output_;
  std::size_t skip_;
  double radius_;
  Eigen::Map<const Eigen::VectorXd> wanted_;
};

struct Start {
  double left = INFINITY;
  Eigen::VectorXd poles;
};

/// The best of `count` passes and where it was.
Start best_of_passes(const Passes& passes, Start from, int count) {
  Eigen::VectorXd poles = from.poles;
  for (int pass = 0; pass < count; ++pass) {
    poles = passes.next(poles);
    const double left = passes.left(poles);
    if (left < from.left) from = {left, poles};
  }
  return from;
}

/// Each mode of a fourth-order denominator with another one added, slow ones with little damping
/// among them, best first: the passes may end where one mode is wasted.
std::vector<Start> with_other_modes(const Passes& passes, const Eigen::VectorXd& poles) {
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(4, 4);
  companion.row(0) = -poles.transpose();
  for (Eigen::Index i = 1; i < 4; ++i) companion(i, i - 1) = 1.0;
  std::vector<Start> starts;
  for (const std::complex<double>& root : Eigen::VectorXcd(companion.eigenvalues())) {
    if (!(root.imag() > 0.0)) continue;
    const double a1 = -2.0 * root.real();
    const double a2 = std::norm(root);
    for (const double turn : {0.05, 0.08, 0.12, 0.18, 0.27, 0.4}) {  // rad a sample
      for (const double ratio : {0.04, 0.3}) {
        const double radius = std::exp(-ratio * turn);
        const double b1 = -2.0 * radius * std::cos(turn * std::sqrt(1.0 - ratio * ratio));
        const double b2 = radius * radius;
        Eigen::VectorXd both(4);
        both << a1 + b1, a2 + b2 + a1 * b1, a1 * b2 + a2 * b1, a2 * b2;
        starts.push_back({passes.left(both), std::move(both)});
      }
    }
  }
  std::ranges::sort(starts, {}, &Start::left);
  return starts;
}

}  // namespace

double left_by_difference_equation(const Series& input, const Series& output, std::size_t order,
                                   std::size_t skip, double longest_samples) {
  if (skip < order || output.size() < skip + 10 * order) return std::nan("");
  constexpr int kPasses = 25;
  constexpr int kPassesAgain = 10;
  constexpr std::size_t kStartsAgain = 3;
  const Passes passes(input, output, skip, longest_samples);
  Start best = best_of_passes(
      passes, {INFINITY, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(order))}, kPasses);
  if (order != 4) return best.left;
  std::vector<Start> others = with_other_modes(passes, best.poles);
  others.resize(std::min(others.size(), kStartsAgain));
  for (Start& other : others) {
    other = best_of_passes(passes, std::move(other), kPassesAgain);
    if (other.left < best.left) best = std::move(other);
  }
  return best.left;
}

}  // namespace stillhand::planted
