// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/change_chart.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace stillhand::statistics {
namespace {

// Eq. ST-23, in standard deviations.
constexpr double kAllowance = 1.5;
// Eq. ST-22: so many vectors wait before they are learnt, so that a change does not hide itself.
constexpr std::int64_t kWait = 8;
// Mean and covariance of so many leave degrees of freedom to judge by.
constexpr std::int64_t kLeast = 4;

// Eq. ST-24.
double threshold_of(double run_length) {
  const double l = std::log(run_length);
  return -3.16 + (0.690 + 0.1083 * l) * l;
}

}  // namespace

ChangeChart::ChangeChart(double run_length) : threshold_(threshold_of(run_length)) {}

void ChangeChart::restart() noexcept {
  count_ = learnt_ = 0;
  cusum_.setZero();
  mean_.setZero();
  scatter_.setZero();
}

Eigen::Vector2d ChangeChart::judged(const Eigen::Vector2d& x) const noexcept {
  const Eigen::LLT<Eigen::Matrix2d> root(scatter_);
  if (learnt_ < kLeast || root.info() != Eigen::Success) return Eigen::Vector2d::Zero();
  const auto n = static_cast<double>(learnt_);
  const Eigen::Vector2d u = std::sqrt(n / (n + 1.0)) * root.matrixL().solve(x - mean_);
  const double square = u.squaredNorm();
  if (!(square > 0.0)) return Eigen::Vector2d::Zero();
  return u * std::sqrt((n - 2.0) * std::log1p(square) / square);
}

void ChangeChart::learn(const Eigen::Vector2d& x) noexcept {
  const auto n = static_cast<double>(learnt_++);
  const Eigen::Vector2d apart = x - mean_;
  mean_ += apart / (n + 1.0);
  scatter_ += n / (n + 1.0) * apart * apart.transpose();
}

// Eq. ST-25.
ChangeChart::Step ChangeChart::dated() const noexcept {
  const Eigen::LLT<Eigen::Matrix2d> root(scatter_);
  const auto all = std::min(count_, static_cast<std::int64_t>(kRemembered));
  Eigen::Vector2d before = Eigen::Vector2d::Zero();
  for (std::int64_t ago = 1; ago <= all; ++ago) before += past(ago);
  Eigen::Vector2d after = Eigen::Vector2d::Zero();
  Step out{true, 1, Eigen::Vector2d::Zero()};
  double best = 0.0;
  for (std::int64_t ago = 1; ago < all; ++ago) {
    before -= past(ago);
    after += past(ago);
    const auto n = static_cast<double>(ago);
    const auto m = static_cast<double>(all - ago);
    const Eigen::Vector2d by = after / n - before / m;
    const double gained = n * m * root.matrixL().solve(by).squaredNorm();
    if (gained <= best) continue;
    best = gained;
    out.ago = ago;
    out.by = by;
  }
  return out;
}

ChangeChart::Step ChangeChart::step(const Eigen::Vector2d& x) noexcept {
  const Eigen::Vector2d reached = cusum_ + judged(x);
  newest_[static_cast<std::size_t>(count_) % kRemembered] = x;
  ++count_;
  if (count_ > kWait) learn(past(kWait + 1));
  const double left = reached.norm() - kAllowance;
  cusum_ = left > 0.0 ? Eigen::Vector2d(reached * (left / (left + kAllowance)))
                      : Eigen::Vector2d::Zero().eval();
  if (left <= threshold_) return {};
  Step out = dated();
  restart();
  return out;
}

}  // namespace stillhand::statistics
