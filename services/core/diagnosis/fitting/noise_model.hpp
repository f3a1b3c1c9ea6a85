// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// The filter that makes the noise of a residual white, Eq. DG-61: an autoregressive model of the
/// residual, its order by Akaike's criterion, by Levinson's recursion on the autocovariance over
/// the samples that count.
/// @param residual  [unit of the output], weighted, one value a sample
/// @return taps c_0 .. c_p of e(n) = sum c_k r(n - k), scaled so that e has the mean square of r;
///         empty where the noise is white enough: one step ahead it can't be predicted by 10 % of
///         its variance
/// Source: Levinson, J. Math. Phys. 25, 1946; Akaike, IEEE Trans. Autom. Control 19, 1974.
std::vector<double> whitening_taps(const Eigen::VectorXd& residual, const Signals& signals);

/// The same taps however white the noise is; empty for a residual of zeros.  A fitted number that
/// is slow feels a colour that hardly helps to predict one step, Eq. DG-70.
std::vector<double> noise_taps(const Eigen::VectorXd& residual, const Signals& signals);

/// 1 + 2 sum rho_k up to the first correlation below 0.05, at most 10 s and a quarter of the
/// record: the number of samples that hold as much information as one independent sample.
/// @param residual  [unit of the output], one value a sample
double correlation_samples(const Eigen::VectorXd& residual, double rate_hz);

}  // namespace stillhand::diagnosis
