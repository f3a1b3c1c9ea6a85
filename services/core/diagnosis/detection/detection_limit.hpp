// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "services/core/diagnosis/selection.hpp"

namespace stillhand::diagnosis {

/// 1 + 2 sum rho_k up to the first correlation below 0.05, at most 10 s and a quarter of the
/// record: the number of samples that hold as much information as one independent sample.
/// @param residual  [unit of the output], one value a sample
double correlation_samples(const Eigen::VectorXd& residual, double rate_hz);

/// What one round of the search has to judge by.
struct RoundEvidence {
  double rmse = 0.0;           ///< [unit of the output] of the residual
  double independent = 0.0;    ///< [-] samples, each with the information of one independent sample
  std::size_t blocks = 0;      ///< [-] over which they are spread
  std::size_t candidates = 0;  ///< [-] that the round tries
};

/// The size of effect that the search finds as often as not, Eq. DG-62: RMS of what it adds to the
/// output and the linear model cannot imitate.
/// @return [unit of the output]
double detection_limit(const RoundEvidence& round, const SearchOptions& options);

}  // namespace stillhand::diagnosis
