// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "identification/core/record.hpp"

namespace stillhand::identification {

/// Orders that can be asked for.
inline constexpr int kMinOrder = 1;
inline constexpr int kMaxOrder = 12;

/// A fitted model and what speaks for it.
struct ArxFit {
  DifferenceModel model;          ///< from the whole record
  FitQuality heldout;             ///< of a fit to the first three quarters, on the last quarter
  double condition_number = 0.0;  ///< [-] of the data matrix with columns scaled to norm 1
  bool stable = false;            ///< that fit and this one
};

/// The paper's fit, README Eq. ID-1 and ID-2 (paper Eqs 3 to 5): least squares on
///
///   f(n) = sum_{i=0..p} c_i a(n-i) - sum_{j=1..p} d_j f(n-j),   n = p .. N-1
///
/// by Householder QR with column pivoting of the data matrix A.  The normal equations (A^T A)^-1 of
/// Eq. 5 give the same answer in exact arithmetic but square the condition number.
/// Equation error: unbiased only when the noise is white through 1/D(z); refine_output_error()
/// removes the bias of output noise.  Pure.
/// @param order  p, kMinOrder to kMaxOrder
/// @throws stillhand::ConfigError when the order is out of range or check_excitation() says no.
ArxFit fit_arx(const Record& record, int order);

}  // namespace stillhand::identification
