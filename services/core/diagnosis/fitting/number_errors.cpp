// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/number_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/expects.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

// Of the largest eigenvalue: columns that come from differences are right to 1e-6 of their length,
// and so a direction that changes nothing has an eigenvalue of some 1e-12.
constexpr double kUndetermined = 1e-10;
// Of a gradient's squared length: what differences leave in a direction that changes nothing.
constexpr double kNoPart = 1e-6;
constexpr double kStepErrors = 1e-3;  // [standard errors] of one number if all others are known
constexpr double kLeastStep = 1e-7;   // of the number, so that rounding stays small

// Eq. DG-70: C^-T x of the noise model e = C r, each stretch by itself: backwards in time.
void spread_by_noise(const std::vector<double>& taps, const Signals& signals,
                     Eigen::MatrixXd& columns) {
  const auto order = static_cast<Eigen::Index>(taps.size()) - 1;
  for (const Stretch& stretch : signals.stretches()) {
    const auto first = static_cast<Eigen::Index>(stretch.first);
    const auto end = static_cast<Eigen::Index>(stretch.end);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      double* x = columns.col(c).data();
      for (Eigen::Index n = end; n-- > first;) {
        double sum = x[n];
        const Eigen::Index most = std::min(order, end - 1 - n);
        for (Eigen::Index k = 1; k <= most; ++k)
          sum -= taps[static_cast<std::size_t>(k)] * x[n + k];
        x[n] = sum / taps[0];
      }
    }
  }
}

double sum_of_weights(const FreeRun& run) {
  double sum = 0.0;
  for (const double weight : run.weight) sum += weight;
  return sum;
}

}  // namespace

NumberErrors::NumberErrors(const Model& model, const Linearisation& line, const Signals& signals)
    : model_(model) {
  STILLHAND_EXPECTS(!signals.is_whitened());
  const Eigen::VectorXd numbers = packed(model);
  const Eigen::Index count = numbers.size();
  scale_ = Eigen::VectorXd::Ones(count);
  step_ = (kLeastStep * numbers.cwiseAbs()).cwiseMax(1e-12);
  covariance_ = Eigen::MatrixXd::Zero(count, count);
  undetermined_ = Eigen::MatrixXd::Identity(count, count);
  const double left = line.finite ? sum_of_weights(line.run) - static_cast<double>(count) : 0.0;
  if (left < 1.0) return;
  const Eigen::VectorXd length = line.jacobian.colwise().norm();
  for (Eigen::Index i = 0; i < count; ++i) {
    if (length[i] > 0.0) scale_[i] = 1.0 / length[i];
  }
  const Eigen::MatrixXd unit = line.jacobian * scale_.asDiagonal();
  const auto [value, vectors] = signal::symmetric_eigenvectors(unit.transpose() * unit);
  const Eigen::Index weak = (value.array() < kUndetermined * value[count - 1]).count();
  undetermined_ = vectors.leftCols(weak);
  const Eigen::VectorXd root = value.tail(count - weak).cwiseSqrt();
  const Eigen::MatrixXd to_numbers =
      vectors.rightCols(count - weak) * root.cwiseInverse().asDiagonal();
  Eigen::MatrixXd spread = unit * to_numbers;
  const std::vector<double> taps = noise_taps(line.residual, signals);
  if (!taps.empty()) spread_by_noise(taps, signals, spread);
  const double variance = line.residual.squaredNorm() / left;
  covariance_ = variance * (to_numbers * (spread.transpose() * spread) * to_numbers.transpose());
  step_ = step_.cwiseMax(kStepErrors * std::sqrt(variance) * scale_);
}

double NumberErrors::along(const Eigen::VectorXd& gradient) const {
  const Eigen::VectorXd scaled = gradient.cwiseProduct(scale_);
  if (!scaled.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const double outside = (undetermined_.transpose() * scaled).squaredNorm();
  if (outside > kNoPart * scaled.squaredNorm()) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(std::max(scaled.dot(covariance_ * scaled), 0.0));
}

double NumberErrors::of_number(std::size_t i) const {
  return along(Eigen::VectorXd::Unit(scale_.size(), static_cast<Eigen::Index>(i)));
}

std::vector<double> NumberErrors::of(
    const std::function<std::vector<double>(const Model&)>& values) const {
  const Eigen::VectorXd numbers = packed(model_);
  Eigen::MatrixXd gradients;
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    Model up = model_;
    Model down = model_;
    unpack(numbers + step_[i] * Eigen::VectorXd::Unit(numbers.size(), i), up);
    unpack(numbers - step_[i] * Eigen::VectorXd::Unit(numbers.size(), i), down);
    // A number at its bound moves to one side alone.
    const double moved = packed(up)[i] - packed(down)[i];
    const std::vector<double> above = values(up);
    const std::vector<double> below = values(down);
    if (i == 0) gradients.setZero(numbers.size(), static_cast<Eigen::Index>(above.size()));
    for (std::size_t v = 0; v < above.size() && moved > 0.0; ++v) {
      gradients(i, static_cast<Eigen::Index>(v)) = (above[v] - below[v]) / moved;
    }
  }
  std::vector<double> errors;
  for (Eigen::Index v = 0; v < gradients.cols(); ++v) errors.push_back(along(gradients.col(v)));
  return errors;
}

}  // namespace stillhand::diagnosis
