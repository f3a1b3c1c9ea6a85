// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// Result of the refinement.
struct OutputErrorFit {
  DifferenceModel model;     ///< stable; from the whole record
  FitQuality heldout;        ///< of a fit to the first three quarters, on the last quarter
  bool converged = false;    ///< the gradient vanished; false: the iteration limit came first
  double start_rms_n = 0.0;  ///< [N] free-run error of the (stabilised) start, whole record
  double rms_n = 0.0;        ///< [N] free-run error reached, never above start_rms_n
};

/// Refines a model on its free-run (simulation) error, METHOD Eq. ID-6: minimises
///
///   V(c, d) = sum (f(n) - f_sim(n; c, d))^2,   D(z) f_sim = C(z) a
///
/// by Levenberg-Marquardt with exact sensitivities by filtering, Eq. ID-7:
/// df_sim/dc_i = z^-i a / D, df_sim/dd_j = -z^-j f_sim / D.  Unbiased by output noise of any
/// colour. A step that would leave the stable region is refused.  An unstable start has its poles
/// mirrored into the unit circle first.  Source: Ljung, System Identification, 2nd ed.,
/// sections 10.2, 10.3. Pure; deterministic.
/// @param start  a model at the record's rate, as from fit_arx()
/// @throws stillhand::ConfigError as check(), or when start and record don't fit together.
OutputErrorFit refine_output_error(const Record& record, const DifferenceModel& start);

}  // namespace stillhand::identification
