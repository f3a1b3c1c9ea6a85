// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace stillhand::planted {

using Series = std::vector<double>;

double mean_of(const Series& values);
/// Root mean square about the mean.
double spread_of(const Series& values);
/// Subtracts the mean, then scales to this root mean square (a constant series stays zero).
void standardise(Series& values, double rms);

/// In place, Butterworth of even order (sections of two poles), bilinear with warped corner.
void low_pass(Series& values, double rate_hz, double corner_hz, std::size_t order);
void high_pass(Series& values, double rate_hz, double corner_hz, std::size_t order);
/// In place, tau y' = x - y by the trapezoidal rule, started at the first value.
void lag(Series& values, double rate_hz, double tau_s);

/// In place, y'' + 2 d w y' + w^2 y = w^2 x, bilinear; at rest before.
void resonate(Series& values, double rate_hz, double natural_hz, double damping);
/// In place, follows the input with a clearance of `half_width` on each side.
void play(Series& values, double half_width);

/// Lagrange polynomial through four neighbours; `position` in samples, inside the series.
double interpolate(const Series& values, double position);

}  // namespace stillhand::planted
