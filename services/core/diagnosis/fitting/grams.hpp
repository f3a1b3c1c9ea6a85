// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"

namespace stillhand::diagnosis {

/// Products of the columns [jacobian | residual] with themselves, a block each: all that a
/// least-squares step and its cross-validation need to know, Eq. DG-11.
struct Grams {
  std::vector<Eigen::MatrixXd> blocks;  ///< [blocks][(numbers + 1) x (numbers + 1)]
  std::vector<double> weights;          ///< [blocks] sum of the weights

  /// Sum over the blocks outside `fold`; -1: all.
  [[nodiscard]] Eigen::MatrixXd total(const Blocks& blocks, int without_fold = -1) const;
};

Grams grams_of(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
               const std::vector<double>& weight, const Blocks& blocks);

}  // namespace stillhand::diagnosis
