// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/surrogates.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/other_phases.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::uint64_t kPhases = 93;
// A surrogate that is hardly moved would keep what a slow channel explains.
constexpr double kLeastMoved = 0.1;

Eigen::VectorXd with_other_phases(const Eigen::VectorXd& residual,
                                  const std::vector<double>& weight, std::size_t draw) {
  const Eigen::Map<const Eigen::VectorXd> rows(weight.data(), std::ssize(weight));
  const std::vector<double> turned =
      other_phases({residual.begin(), residual.end()}, signal::Gaussian(kPhases, draw));
  Eigen::VectorXd other =
      Eigen::Map<const Eigen::VectorXd>(turned.data(), residual.size()).cwiseProduct(rows);
  return other * (residual.norm() / std::max(other.norm(), 1e-300));
}

}  // namespace

Eigen::VectorXd moved_in_time(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                              double part, bool backwards) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index n = 0; n < residual.size(); ++n) {
    if (weight[static_cast<std::size_t>(n)] > 0.0) rows.push_back(n);
  }
  const auto shift = static_cast<std::size_t>(part * static_cast<double>(rows.size()));
  Eigen::VectorXd other = Eigen::VectorXd::Zero(residual.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t from = (i + shift) % rows.size();
    other[rows[i]] = residual[rows[backwards ? rows.size() - 1 - from : from]];
  }
  return other;
}

Eigen::MatrixXd surrogates(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                           std::size_t count) {
  Eigen::MatrixXd all(residual.size(), static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const double part = kLeastMoved + (1.0 - 2.0 * kLeastMoved) * (static_cast<double>(i) + 0.5) /
                                          static_cast<double>(count);
    all.col(static_cast<Eigen::Index>(i)) = i % 2 == 0 ? moved_in_time(residual, weight, part, true)
                                                       : with_other_phases(residual, weight, i);
  }
  return all;
}

double surrogate_p(double value, const Eigen::ArrayXd& of_surrogates) {
  return (1.0 + static_cast<double>((of_surrogates >= value).count())) /
         (1.0 + static_cast<double>(of_surrogates.size()));
}

SurrogateGains::SurrogateGains(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                               const std::vector<double>& weight, const Blocks& blocks)
    : jacobian_(jacobian),
      weight_(weight),
      blocks_(blocks),
      residuals_(residual.size(), kSurrogates + 1) {
  residuals_ << residual, surrogates(residual, weight, kSurrogates);
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const auto [first, rows] = rows_of(blocks, b, residual.size());
    own_products_.push_back(jacobian.middleRows(first, rows).transpose() *
                            residuals_.middleRows(first, rows));
  }
  without_ = held_out_squares(Eigen::MatrixXd(residual.size(), 0));
}

SurrogateShares SurrogateGains::shares(const Eigen::MatrixXd& more) const {
  Eigen::ArrayXd of_all = 1.0 - held_out_squares(more) / without_.max(1e-300);
  of_all = of_all.isFinite().select(of_all, -1.0);
  return {of_all[0], of_all.tail(kSurrogates)};
}

// Eq. DG-12 for many residuals: the products of the columns are the same for all of them.
Eigen::ArrayXd SurrogateGains::held_out_squares(const Eigen::MatrixXd& more) const {
  const Eigen::Index own = jacobian_.cols();
  const Eigen::Index size = own + more.cols();
  Eigen::MatrixXd columns(more.rows(), size);
  columns << jacobian_, more;
  const Grams grams = grams_of(columns, residuals_.col(0), weight_, blocks_);
  std::vector<Eigen::MatrixXd> products;
  for (std::size_t b = 0; b < blocks_.count; ++b) {
    const auto [first, rows] = rows_of(blocks_, b, more.rows());
    Eigen::MatrixXd& all = products.emplace_back(size, residuals_.cols());
    all.topRows(own) = own_products_[b];
    all.bottomRows(more.cols()) =
        more.middleRows(first, rows).transpose() * residuals_.middleRows(first, rows);
  }
  const auto in_fold = [&](std::size_t b, std::size_t fold) { return blocks_.fold_of(b) == fold; };
  Eigen::ArrayXd squares = residuals_.colwise().squaredNorm().transpose();
  for (std::size_t fold = 0; fold < blocks_.folds; ++fold) {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(size, residuals_.cols());
    for (std::size_t b = 0; b < blocks_.count; ++b) {
      if (!in_fold(b, fold)) sums += products[b];
    }
    const Eigen::MatrixXd training =
        grams.total(blocks_, static_cast<int>(fold)).topLeftCorner(size, size);
    const Eigen::MatrixXd steps = held_out_steps(training, sums);
    for (std::size_t b = 0; b < blocks_.count; ++b) {
      if (!in_fold(b, fold)) continue;
      const Eigen::MatrixXd gram = grams.blocks[b].topLeftCorner(size, size);
      const Eigen::MatrixXd change = gram * steps - 2.0 * products[b];
      squares += steps.cwiseProduct(change).colwise().sum().transpose().array();
    }
  }
  return squares;
}

}  // namespace stillhand::diagnosis
