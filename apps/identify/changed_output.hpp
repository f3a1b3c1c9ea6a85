// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace stillhand::identify {

/// Rows [first, end) in which y has another gain or another level over a prediction p of it, by
/// least squares; a twentieth of the rows or more lie inside, and outside:
///
///   y = gain[k] p + level   or   y = gain p + level[k],   k = 1 inside, 0 outside
struct Change {
  std::size_t first = 0;
  std::size_t end = 0;
  bool of_level = false;
  double gain = 1.0;         ///< [-] gain[1] / gain[0]
  double level = 0.0;        ///< [unit of y] level[1] - level[0]
  double error_ratio = 1.0;  ///< [-] squared error over that of y = gain p + level
};

/// The one with the least error, to a row; where it ends within the record, it was sought on a grid
/// of a hundredth of the record first.  Pure.  @param y, p  one length, at least 40
Change change_of(const std::vector<double>& y, const std::vector<double>& p);

}  // namespace stillhand::identify
