// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/legend_layout.hpp"

#include <algorithm>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report {
namespace {
constexpr double kBetweenEntries_px = 18.0;
}

LegendBlock flow_legend(const std::vector<Series>& series, double width_px) {
  LegendBlock block;
  double left_px = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (!series[i].show_in_legend || series[i].label.empty()) continue;
    const double entry_px = kSampleToText_px + text_width_px(series[i].label, kFontSize_px);
    if (block.rows == 0 || left_px + entry_px > width_px) {
      ++block.rows;
      left_px = 0.0;
    }
    block.entries.push_back({i, left_px, kLegendRow_px * (block.rows - 0.5)});
    block.width_px = std::max(block.width_px, left_px + entry_px);
    left_px += entry_px + kBetweenEntries_px;
  }
  return block;
}

std::vector<LegendEntry> moved(const LegendBlock& block, double left_px, double top_px) {
  std::vector<LegendEntry> entries = block.entries;
  for (LegendEntry& entry : entries) {
    entry.left_px += left_px;
    entry.middle_px += top_px;
  }
  return entries;
}

}  // namespace stillhand::report
