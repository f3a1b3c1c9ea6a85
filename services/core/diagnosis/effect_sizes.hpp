// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

#include "services/core/diagnosis/fitting/number_errors.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/size.hpp"

/// Physical numbers of a model's effects with their standard errors, METHOD "Sizes".  Pure.
namespace stillhand::diagnosis {

/// What an effect's sizes are made of, at the model as it was fitted.
/// @param run  of the model over the signals
SizeCase size_case(const Model& model, std::size_t which, const Signals& signals,
                   const FreeRun& run);

/// Of one effect: the kind's own first, then the numbers that were fitted, searched or given.
/// Coefficients of a path through the body or of a loop are left out: a single one has no meaning.
std::vector<Size> effect_sizes(const SizeCase& at, const NumberErrors& errors);

/// A path's response with its standard errors.
struct ResponsePoint {
  double frequency_hz = 0.0;
  std::complex<double> response;  ///< [output unit per unit of what drives it]
  double magnitude_error = 0.0;   ///< of its magnitude, same unit
  double phase_error_rad = 0.0;
};

/// Of an effect that is a linear path; empty: it is none.
std::vector<ResponsePoint> path_response(const SizeCase& at, const NumberErrors& errors,
                                         const std::vector<double>& frequencies_hz);

/// Place of an effect's first fitted number in packed().
std::size_t first_number(const Model& model, std::size_t which);

}  // namespace stillhand::diagnosis
