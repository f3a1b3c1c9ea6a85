// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

/// Paths that start in the steady state of their first inputs, METHOD Eq. DG-54.  Pure.
namespace stillhand::diagnosis {

/// A signal, and the level that it held before each stretch.
struct Settled {
  std::vector<double> values;  ///< one a sample
  std::vector<double> before;  ///< [stretches]
};

/// Level before each stretch, Eq. DG-54: the mean m of its first second, as far as it stands out of
/// the swing s (deviation) within that second; 0 for a signal that swings about 0.
///
///   m clip((m^2 - s^2) / (3 s^2), 0, 1)
std::vector<double> start_levels(const std::vector<double>& x, const Signals& signals);
/// x, and its levels.
Settled settled(std::vector<double> x, const Signals& signals);

/// x / A(q); before the stretch x's level over A(1).
Settled through_poles(const Settled& x, const std::vector<double>& denominator,
                      const std::vector<Stretch>& stretches);
/// x(n) - x(n-1); 0 before the stretch.
Settled differenced(const Settled& x, const std::vector<Stretch>& stretches);
/// x(n-1)
Settled late(const Settled& x, const std::vector<Stretch>& stretches);
/// sum += factor x, before the stretches too.
void add_scaled(const Settled& x, double factor, Settled& sum);

}  // namespace stillhand::diagnosis
