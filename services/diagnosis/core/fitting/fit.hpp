// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "services/diagnosis/core/model/evaluation.hpp"

namespace stillhand::diagnosis {

/// Blocks of equal length in time, and which fold of a cross-validation each is in: block b in fold
/// b mod folds, so that every fold is spread over the whole record, unless `fold` says otherwise.
struct Blocks {
  std::size_t length = 1;  ///< [samples]
  std::size_t count = 1;
  std::size_t folds = 2;
  std::vector<std::size_t> fold = {};  ///< [blocks], or empty

  [[nodiscard]] std::size_t fold_of(std::size_t block) const noexcept {
    return fold.empty() ? block % folds : fold[block];
  }
};

/// About 30 blocks of at least 2 s, 5 folds.  @throws stillhand::ConfigError for a record of fewer
/// than 10 blocks of 5 samples.
Blocks make_blocks(const Signals& signals);

/// The same blocks, a fold for each of the recordings that were joined; a block over a seam belongs
/// to the one that has more of it.
Blocks by_recording(const Blocks& blocks, const Signals& signals);

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
};

struct FitOptions {
  int max_iterations = 20;
  int without_fold = -1;             ///< fold that is left out; -1: none
  double relative_tolerance = 1e-7;  ///< of the sum of squares, between two steps
};

/// Minimises the free-run error of all the fitted numbers of a model together (output error, joint
/// with every effect), Eq. DG-9, by Levenberg and Marquardt (ceres::TinySolver on the compressed
/// normal equations).  A step to an unstable body is refused.  Never ends worse than it began.
FitResult fit(Model& model, const Signals& signals, const Blocks& blocks,
              const FitOptions& options = {});

/// Sums of squared errors a block, of predictions by a model fitted without the block's fold.
struct HeldOut {
  bool finite = false;
  std::vector<double> squares;  ///< [blocks]
  std::vector<double> weights;  ///< [blocks]

  [[nodiscard]] double rmse() const;
};

double sum_of(const std::vector<double>& values);

/// Every fold predicted by a fit to the others, from one linearisation at the fit to all, Eq.
/// DG-12.
HeldOut held_out_linearised(const Grams& grams, const Blocks& blocks);
/// The same by refitting the model five times, started at the fit to all.
HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks);

}  // namespace stillhand::diagnosis
