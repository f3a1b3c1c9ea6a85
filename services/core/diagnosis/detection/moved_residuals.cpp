// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/moved_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/detection/surrogates.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
MovedResiduals::MovedResiduals(const Model& model, const Signals& signals, const Blocks& blocks,
                               const Eigen::MatrixXd& columns, std::size_t count)
    : blocks_(blocks), columns_(columns.cols()), residuals_(static_cast<Eigen::Index>(count)) {
  const Linearisation line = linearised(model, signals);
  own_ = line.jacobian.cols();
  Eigen::MatrixXd all(line.residual.size(), own_ + columns_ + residuals_);
  all.leftCols(own_) = line.jacobian;
  auto next_to_it = all.middleCols(own_, columns_);
  const Eigen::Map<const Eigen::VectorXd> weight(line.run.weight.data(),
                                                 std::ssize(line.run.weight));
  next_to_it = columns.array().colwise() * weight.array();
  InitialStates(model, signals, line.run.weight).remove_from(next_to_it);
  signals.whiten(next_to_it, line.run.weight);
  for (std::size_t i = 0; i < count; ++i) {
    const double part = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    all.col(own_ + columns_ + static_cast<Eigen::Index>(i)) =
        moved_in_time(line.residual, line.run.weight, part, i % 2 == 1);
  }
  grams_ = grams_of(all.leftCols(all.cols() - 1), all.col(all.cols() - 1), line.run.weight, blocks);
}

double MovedResiduals::beyond(Eigen::Index k) const {
  const Eigen::MatrixXd total = grams_.total(blocks_);
  const Eigen::VectorXd scale =
      total.diagonal().head(own_).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd normal =
      scale.asDiagonal() * total.topLeftCorner(own_, own_) * scale.asDiagonal();
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd b = scale.asDiagonal() * total.col(own_ + k).head(own_);
  const double all = total(own_ + k, own_ + k);
  return std::sqrt(std::max(1.0 - b.dot(signal::solve_symmetric(normal, b)) / all, 0.0));
}

Grams MovedResiduals::grams(Eigen::Index k, double factor, std::size_t residual,
                            bool with_column) const {
  const Eigen::Index r = own_ + columns_ + static_cast<Eigen::Index>(residual);
  const Eigen::Index d = own_ + k;
  const Eigen::Index fitted = with_column ? own_ + 1 : own_;
  Grams result;
  result.weights = grams_.weights;
  for (const Eigen::MatrixXd& all : grams_.blocks) {
    Eigen::MatrixXd gram(fitted + 1, fitted + 1);
    gram.topLeftCorner(own_, own_) = all.topLeftCorner(own_, own_);
    gram.col(fitted).head(own_) = all.col(r).head(own_) + factor * all.col(d).head(own_);
    if (with_column) {
      gram.col(own_).head(own_) = all.col(d).head(own_);
      gram.row(own_).head(own_) = all.row(d).head(own_);
      gram(own_, own_) = all(d, d);
      gram(own_, fitted) = all(d, r) + factor * all(d, d);
    }
    gram(fitted, fitted) = all(r, r) + factor * (2.0 * all(d, r) + factor * all(d, d));
    gram.row(fitted).head(fitted) = gram.col(fitted).head(fitted).transpose();
    result.blocks.push_back(std::move(gram));
  }
  return result;
}

}  // namespace stillhand::diagnosis
