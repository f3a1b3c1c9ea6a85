// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// An output that is the size of a linear response, with the sign that it lost, Eq. DG-85:
///
///   y = |h' x|,  y^2 = x' (h h') x,  x: the inputs behind Laguerre functions, and 1
///
/// The square is linear in the products of x; the first eigenvector of their factors is h.  Then
/// sign(h' x) y is fitted by h' x, again and again, until no sign changes.  The best of some
/// Laguerre poles.  No body from the wrong signs is near the right one.
/// Source: Fienup, Applied Optics 21, 1982 (signs in turn); Candes, Strohmer and Voroninski, Comm.
/// Pure Appl. Math. 66, 2013 (the square as a linear problem).
std::vector<double> with_lost_sign(const Signals& signals);

}  // namespace stillhand::diagnosis
