// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "tests/planted/filters.hpp"

namespace stillhand::planted {

/// What the best finite impulse response from `input` plus a constant leaves of `output`, by
/// ordinary least squares: what no linear time-invariant model of that memory explains.  The first
/// taps * stride samples are left out, then every stride-th is told.
/// @param stride  samples between taps, and between the rows of the fit
Series beyond_impulse_response(const Series& input, const Series& output, std::size_t taps,
                               std::size_t stride);

/// Root mean square left of `output` by a difference equation of the given order plus a constant,
/// run free from an initial state of its own and fitted to its simulation error (Steiglitz and
/// McBride 1965, the best of its passes; of order 4 also from starts with one mode exchanged): an
/// upper bound of the best possible.
/// @param skip  samples at the start that count nothing
/// @param longest_samples  no pole forgets more slowly: poles on the unit circle, set off by the
///        first samples, would swallow tones and drifts
double left_by_difference_equation(const Series& input, const Series& output, std::size_t order,
                                   std::size_t skip, double longest_samples);

}  // namespace stillhand::planted
