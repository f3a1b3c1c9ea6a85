// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/impulse_response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kImpulseResponse_s = 1.5;
constexpr std::size_t kMostLags = 200;
constexpr double kTapRidge = 1e-9;

// Sums over a stretch's rows of products of lagged signals, by the shift recursion
// G(i+1, j+1) = G(i, j) + the row before the first - the last row: samples times lags, not lags
// squared.
Eigen::MatrixXd lagged_products(const std::vector<double>& x, const std::vector<double>& y,
                                std::size_t first_row, std::size_t end_row, std::size_t lags) {
  const auto size = static_cast<Eigen::Index>(lags);
  Eigen::MatrixXd products(size, size);
  const auto dot = [&](std::size_t i, std::size_t j) {
    double sum = 0.0;
    for (std::size_t n = first_row; n < end_row; ++n) sum += x[n - i] * y[n - j];
    return sum;
  };
  for (std::size_t i = 0; i < lags; ++i) {
    products(static_cast<Eigen::Index>(i), 0) = dot(i, 0);
    products(0, static_cast<Eigen::Index>(i)) = dot(0, i);
  }
  for (std::size_t i = 1; i < lags; ++i) {
    for (std::size_t j = 1; j < lags; ++j) {
      const double entering = x[first_row - i] * y[first_row - j];
      const double leaving = x[end_row - i] * y[end_row - j];
      products(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          products(static_cast<Eigen::Index>(i - 1), static_cast<Eigen::Index>(j - 1)) + entering -
          leaving;
    }
  }
  return products;
}

void add_lagged_sums(const Signals& signals, const std::vector<double>& target, std::size_t k,
                     const Stretch& stretch, std::size_t lags, Eigen::MatrixXd& normal,
                     Eigen::VectorXd& right) {
  const std::vector<double>& u = signals.inputs()[k].values;
  const auto size = static_cast<Eigen::Index>(lags);
  const Eigen::Index at = 1 + static_cast<Eigen::Index>(k) * size;
  const std::size_t first = stretch.first + lags;
  for (std::size_t i = 0; i < lags; ++i) {
    double sum = 0.0;
    double product = 0.0;
    for (std::size_t n = first; n < stretch.end; ++n) {
      sum += u[n - i];
      product += u[n - i] * target[n];
    }
    normal(at + static_cast<Eigen::Index>(i), 0) += sum;
    normal(0, at + static_cast<Eigen::Index>(i)) += sum;
    right[at + static_cast<Eigen::Index>(i)] += product;
  }
  for (std::size_t other = 0; other < signals.inputs().size(); ++other) {
    normal.block(at, 1 + static_cast<Eigen::Index>(other) * size, size, size) +=
        lagged_products(u, signals.inputs()[other].values, first, stretch.end, lags);
  }
}

}  // namespace

ImpulseResponse fit_impulse_response(const Signals& signals) {
  ImpulseResponse result;
  const std::size_t inputs = signals.inputs().size();
  const std::size_t count = signals.size();
  result.lags = std::min({static_cast<std::size_t>(kImpulseResponse_s * signals.rate_hz()),
                          kMostLags, count / (20 * inputs)});
  result.lags = std::max<std::size_t>(result.lags, 1);
  const auto size = static_cast<Eigen::Index>(1 + inputs * result.lags);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  const std::vector<double>& output = signals.output().values;
  std::vector<Stretch> long_enough;
  for (const Stretch& stretch : signals.stretches()) {
    // One sample is kept behind the last row for the recursion.
    if (stretch.end - stretch.first > 2 * result.lags + 1) {
      long_enough.push_back({stretch.first, stretch.end - 1, stretch.start_s});
    }
  }
  for (const Stretch& stretch : long_enough) {
    for (std::size_t k = 0; k < inputs; ++k) {
      add_lagged_sums(signals, output, k, stretch, result.lags, normal, right);
    }
    for (std::size_t n = stretch.first + result.lags; n < stretch.end; ++n) {
      normal(0, 0) += 1.0;
      right[0] += output[n];
    }
  }
  result.prediction.assign(count, 0.0);
  result.valid.assign(count, false);
  result.rmse = std::numeric_limits<double>::quiet_NaN();
  if (long_enough.empty()) return result;
  // Ridge on the diagonal's size: an input that excites a narrow band leaves the rest open.
  for (Eigen::Index i = 1; i < size; ++i) normal(i, i) *= 1.0 + kTapRidge;
  const Eigen::VectorXd h = signal::solve_symmetric(normal, right);
  double square = 0.0;
  double rows = 0.0;
  for (const Stretch& stretch : long_enough) {
    for (std::size_t n = stretch.first + result.lags; n < stretch.end; ++n) {
      double sum = h[0];
      for (std::size_t k = 0; k < inputs; ++k) {
        const double* taps = h.data() + 1 + k * result.lags;
        const std::vector<double>& u = signals.inputs()[k].values;
        for (std::size_t i = 0; i < result.lags; ++i) sum += taps[i] * u[n - i];
      }
      result.prediction[n] = sum;
      result.valid[n] = true;
      if (signals.weight()[n] > 0.0) {
        square += (output[n] - sum) * (output[n] - sum);
        rows += 1.0;
      }
    }
  }
  result.rmse = std::sqrt(square / std::max(rows - static_cast<double>(size), 1.0));
  return result;
}

}  // namespace stillhand::diagnosis
