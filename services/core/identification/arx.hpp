// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/identification/record.hpp"

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

/// The paper's fit, METHOD Eq. ID-1 and ID-2 (paper Eqs 3 to 5): least squares on
///
///   f(n) = sum_{i=0..p} c_i a(n-i) - sum_{j=1..p} d_j f(n-j),   n = p .. N-1
///
/// with the data matrix A: normal equations, corrected with the residual (Eq. ID-19), and
/// Householder QR with column pivoting where A's condition is 1e5 or worse.
/// Equation error: unbiased only when the noise is white through 1/D(z); refine_output_error()
/// removes the bias of output noise.  Pure.
/// @param order  p, kMinOrder to kMaxOrder
/// @throws stillhand::ConfigError when the order is out of range or check_excitation() says no.
ArxFit fit_arx(const Record& record, int order);

/// The least squares of fit_arx() alone: no excitation asked for, nothing held out.  Without
/// excitation the parameters mean nothing, and may not be finite.
/// @throws stillhand::ConfigError when the order is out of range or the record unsound or too
/// short.
DifferenceModel least_squares(const Record& record, int order);

/// What the least squares of one record needs to know of it: R and Q^T f of A = Q R.
struct ArxFactor {
  int order = 0;
  double rate_hz = 0.0;
  std::vector<double> triangle;  ///< R with Q^T f as its last column, [(2p + 1) x (2p + 2)] by rows
};

/// @throws stillhand::ConfigError when the order is out of range or the record too short.
ArxFactor factor_arx(const Record& record, int order);

/// One model for several records, Eq. ID-18: the least-squares solution on all their samples
/// together, each record's first `order` samples as its own past.
/// @throws stillhand::ConfigError when there is none, or they differ in order or rate.
DifferenceModel fit_pooled(const std::vector<ArxFactor>& factors);

}  // namespace stillhand::identification
