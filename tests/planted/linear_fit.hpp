// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "tests/planted/filters.hpp"

namespace stillhand::planted {

/// Residual of `output` after the best finite impulse response from `input` plus a constant, by
/// ordinary least squares.  No linear time-invariant model of that memory explains this residual.
/// It omits the first taps * stride samples and then contains every stride-th sample.
/// @param stride  samples between taps, and between the rows of the fit
Series beyond_impulse_response(const Series& input, const Series& output, std::size_t taps,
                               std::size_t stride);

/// RMS residual of `output` after a difference equation of the given order plus a constant.  The
/// equation runs free from a fitted initial state and is fitted to its simulation error (Steiglitz
/// and McBride 1965, best pass; for order 4 also from starts with one mode exchanged).  The result
/// is an upper bound of the best possible value.
/// @param skip  number of ignored samples at the start
/// @param longest_samples  longest time constant of a pole: poles on the unit circle, excited by
///        the first samples, would absorb tones and drifts
double left_by_difference_equation(const Series& input, const Series& output, std::size_t order,
                                   std::size_t skip, double longest_samples);

}  // namespace stillhand::planted
