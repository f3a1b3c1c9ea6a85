// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/fitting/fit.hpp"

namespace stillhand::diagnosis {

/// Sums of squared errors a block, of predictions by a model fitted without the block's fold.
struct HeldOut {
  bool finite = false;          ///< a square beyond 1e100, which no test takes, counts as not
  std::vector<double> squares;  ///< [blocks]
  std::vector<double> weights;  ///< [blocks]

  [[nodiscard]] double rmse() const;
};

/// Of squared errors or of weights, over the blocks.
double sum_of(const std::vector<double>& values);

/// By how much a fit to the blocks outside of the fold changes the numbers.
/// @param training  products of the columns with themselves over these blocks [n x n]
/// @param with_residuals  of the columns with residuals [n x any]
/// @return one column a residual
Eigen::MatrixXd held_out_steps(const Eigen::MatrixXd& training,
                               const Eigen::MatrixXd& with_residuals);
/// Every fold predicted by a fit to the others, from one linearisation at the fit to all, Eq.
/// DG-12.
HeldOut held_out_linearised(const Grams& grams, const Blocks& blocks);
/// The same by refitting the model five times, started at the fit to all.
HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks);
/// @param grams  of the model; null: not known, or its run is not finite
HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks,
                 const Grams* grams);

}  // namespace stillhand::diagnosis
