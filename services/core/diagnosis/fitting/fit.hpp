// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/grams.hpp"
#include "services/core/diagnosis/fitting/response_prior.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {

/// Result of a fit.
struct FitResult {
  bool finite = false;
  double rmse = 0.0;           ///< [unit of the output] over the samples it was fitted to, with
                               ///< the prior's terms
  Eigen::VectorXd residual;    ///< of the fitted model over all samples, as in Linearisation
  FreeRun run;                 ///< likewise
  std::optional<Grams> grams;  ///< likewise, if they were asked for and the run is finite
};

struct FitOptions {
  int max_iterations = 20;
  int without_fold = -1;                 ///< fold that is left out; -1: none
  double relative_tolerance = 1e-7;      ///< of the sum of squares, between two steps
  const Grams* at_start = nullptr;       ///< of the model as it is given, where they are known
  bool grams_at_end = false;             ///< the result shall have those of the fitted model
  const ResponsePrior* prior = nullptr;  ///< where the samples do not determine the body
};

/// Minimises the free-run error of all the fitted numbers of a model together (output error, joint
/// with every effect), Eq. DG-9, by Levenberg and Marquardt (ceres::TinySolver on the compressed
/// normal equations).  A step to an unstable body is refused.  Never ends worse than it began.
FitResult fit(Model& model, const Signals& signals, const Blocks& blocks,
              const FitOptions& options = {});

}  // namespace stillhand::diagnosis
