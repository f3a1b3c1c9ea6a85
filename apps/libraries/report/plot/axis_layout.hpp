// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::report {

/// Larger values are gaps, as NaN is: spans and steps of what is drawn must not overflow.
inline constexpr double kLargestValue = 1e100;

/// Range of the values that an axis shows.  Gaps do not count.
struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool marks = false;      ///< holds points, bars or boxes, which need room beyond their centre
  bool from_zero = false;  ///< holds bars, which start at zero

  [[nodiscard]] bool empty() const { return !(low <= high); }
};

/// Limits, ticks and their labels of one axis of one panel.
struct AxisLayout {
  double low = 0.0;
  double high = 1.0;
  bool logarithmic = false;
  bool categories = false;  ///< ticks have names: no grid, no tick marks
  std::vector<AxisTick> major;
  std::vector<double> minor;

  /// Place of a value along the axis [-], 0 at `low`, 1 at `high`; the value is positive on a
  /// logarithmic axis.
  [[nodiscard]] double fraction(double value) const;
  /// Whether a value can be drawn; otherwise it is a gap.
  [[nodiscard]] bool drawable(double value) const;
};

/// Extents of a panel's x and y axis.  If x has limits, only the values between them count for y.
Extent extent_x(const Panel& panel);
Extent extent_y(const Panel& panel);

/// Limits, then ticks.
/// @param length_px       of the axis [px]; decides how many ticks fit
/// @param horizontal      labels stand side by side
/// @param tight           limits at the first and last value (x of lines); otherwise with some room
AxisLayout lay_out_axis(const Axis& axis, const Extent& extent, double length_px, bool horizontal,
                        bool tight, double font_size_px);

}  // namespace stillhand::report
