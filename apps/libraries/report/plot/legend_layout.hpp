// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/libraries/report/plot/panel_layout.hpp"

namespace stillhand::report {

inline constexpr double kLegendRow_px = 19.0;

/// A legend's entries in rows, placed from (0, 0); the caller moves them.
struct LegendBlock {
  std::vector<LegendEntry> entries;
  double width_px = 0.0;
  int rows = 0;

  [[nodiscard]] double height_px() const { return kLegendRow_px * rows; }
};

/// Fills rows from the left until `width_px` is used up; a wider entry has its own row.
/// Series without a label or with show_in_legend off are left out.
LegendBlock flow_legend(const std::vector<Series>& series, double width_px);

/// The entries of a block moved by (left_px, top_px).
std::vector<LegendEntry> moved(const LegendBlock& block, double left_px, double top_px);

}  // namespace stillhand::report
