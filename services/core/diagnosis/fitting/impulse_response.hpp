// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// Impulse responses by least squares, METHOD Eq. DG-13:
///
///   y(n) = offset + sum_k sum_{i=0..L-1} h_k,i u_k(n-i),   n from a stretch's L-th sample on
///
/// L covers 1.5 s, at most 200 samples and a twentieth of the record.  What it leaves is an upper
/// bound of what noise and effects beyond any linear model of the inputs amount to.
struct ImpulseResponse {
  std::vector<double> prediction;  ///< [samples] 0 where a stretch's past is too short
  std::vector<bool> valid;         ///< [samples]
  double rmse = 0.0;               ///< [unit of the output] freed of the numbers fitted
  std::size_t lags = 0;
};

ImpulseResponse fit_impulse_response(const Signals& signals);

}  // namespace stillhand::diagnosis
