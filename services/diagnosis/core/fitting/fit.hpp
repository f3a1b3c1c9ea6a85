// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "services/diagnosis/core/fitting/blocks.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"

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

/// Result of a fit.
struct FitResult {
  bool finite = false;
  double rmse = 0.0;  ///< [unit of the output] over the samples it was fitted to
  int iterations = 0;
  Eigen::VectorXd residual;  ///< of the fitted model over all samples, as in Linearisation
  FreeRun run;               ///< likewise
};

struct FitOptions {
  int max_iterations = 20;
  int without_fold = -1;             ///< fold that is left out; -1: none
  double relative_tolerance = 1e-7;  ///< of the sum of squares, between two steps
  const Grams* at_start = nullptr;   ///< of the model as it is given, where they are known
};

/// Minimises the free-run error of all the fitted numbers of a model together (output error, joint
/// with every effect), Eq. DG-9, by Levenberg and Marquardt (ceres::TinySolver on the compressed
/// normal equations).  A step to an unstable body is refused.  Never ends worse than it began.
FitResult fit(Model& model, const Signals& signals, const Blocks& blocks,
              const FitOptions& options = {});

}  // namespace stillhand::diagnosis
