// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::diagnosis {

/// How much of what effects add to a prediction another recording will show, METHOD Eq. DG-69.
struct Share {
  double estimate = 0.0;   ///< [-] least squares on parts that no fit has seen
  double std_error = 0.0;  ///< [-] over the blocks or over the parts, the larger
  /// [-] the largest with which no part's error grows by more than a twentieth
  double harmless = HUGE_VAL;

  /// [-] 0 to 1: the estimate times what its standard error leaves of it, at most what is harmless,
  /// Eq. DG-68, rounded.
  [[nodiscard]] double earned() const;
};

/// Within a tenth of 0 or 1 it is 0 or 1: a share that is wrong by x loses x^2 of what the effects
/// explain, here at most a hundredth.
double rounded_share(double share);

/// @param residual    [samples] weighted, of the prediction without the effects
/// @param difference  [samples] weighted, what the effects add to that prediction
/// @param parts       of which each fold was held out whole
/// Pure.
Share share_of(const Eigen::VectorXd& residual, const Eigen::VectorXd& difference,
               const Blocks& parts);

/// [-] of a signal's power about its mean that a mean over one period keeps, METHOD Eq. DG-77.
/// @param period  [samples]
double slow_share(Eigen::VectorXd signal, const std::vector<Stretch>& stretches,
                  std::size_t period);

}  // namespace stillhand::diagnosis
