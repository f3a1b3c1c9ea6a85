// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// A line of a spectrum.
struct Line {
  double frequency = 0.0;   ///< [cycles per unit of the axis]
  double power = 0.0;       ///< |sum r exp(-j 2 pi f x)|^2 / n, unit of r squared
  double prominence = 0.0;  ///< [-] power over the median of its surroundings
};

/// Strongest lines of a residual over any axis (time, a position), METHOD Eq. DG-15: the samples
/// are gathered in equal bins of the axis, far finer than the shortest period, and transformed by
/// FFT. Frequencies from `lowest` to `highest` [cycles per unit of the axis] in quarters of
/// 1/range. A line within three times 1/range of a stronger one is that one's side lobe.
/// @param residual  weighted, as long as the axis
std::vector<Line> strongest_lines(const std::vector<double>& axis,
                                  const std::vector<double>& residual, double lowest,
                                  double highest, std::size_t count);

}  // namespace stillhand::diagnosis
