// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/legend_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report::legend_layout_test {

using testing::ElementsAre;

std::vector<Series> labelled(const std::vector<std::string>& labels) {
  std::vector<Series> series;
  for (const std::string& label : labels) series.push_back(Series{.label = label});
  return series;
}

double right_px(const LegendEntry& entry, const std::vector<Series>& series) {
  return entry.left_px + kSampleToText_px + text_width_px(series[entry.series].label, kFontSize_px);
}

TEST(LegendLayoutTest, WithoutLabelsThereAreNoRows) {
  auto series = labelled({"", "hidden"});
  series[1].show_in_legend = false;
  for (const LegendBlock& sut : {flow_legend({}, 500.0), flow_legend(series, 500.0)}) {
    EXPECT_TRUE(sut.entries.empty());
    EXPECT_EQ(sut.rows, 0);
    EXPECT_EQ(sut.height_px(), 0.0);
    EXPECT_EQ(sut.width_px, 0.0);
  }
}

TEST(LegendLayoutTest, AnEntryWiderThanTheLegendHasARowOfItsOwn) {
  const auto series = labelled({"a", std::string(100, 'w'), "b"});
  const LegendBlock sut = flow_legend(series, 200.0);
  EXPECT_EQ(sut.rows, 3);
  for (const LegendEntry& entry : sut.entries) EXPECT_EQ(entry.left_px, 0.0);
  EXPECT_GT(sut.width_px, 200.0);
}

TEST(LegendLayoutTest, AnEntryThatFitsExactlyStaysInItsRow) {
  const auto series = labelled({"aaa", "bbb"});
  const LegendBlock wide = flow_legend(series, 1e6);
  ASSERT_EQ(wide.rows, 1);
  EXPECT_EQ(flow_legend(series, wide.width_px).rows, 1);
  EXPECT_EQ(flow_legend(series, wide.width_px * (1.0 - 1e-12)).rows, 2);
}

// Over random labels and widths: the order is that of the series, entries of a row do not touch, no
// row is left while the next entry fits into it, and the block's size covers its entries.
TEST(LegendLayoutTest, RowsAreFilledInOrderWithoutOverlap) {
  std::mt19937_64 random(61);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::string> labels(random() % 12);
    for (std::string& label : labels) label = std::string(random() % 20, "ilmW."[random() % 5]);
    const auto series = labelled(labels);
    const double width_px = 50.0 + static_cast<double>(random() % 600);
    const LegendBlock sut = flow_legend(series, width_px);
    double widest_px = 0.0;
    for (std::size_t i = 0; i < sut.entries.size(); ++i) {
      const LegendEntry& entry = sut.entries[i];
      widest_px = std::max(widest_px, right_px(entry, series));
      ASSERT_GT(entry.middle_px, 0.0);
      ASSERT_LT(entry.middle_px, sut.height_px());
      ASSERT_TRUE(entry.left_px == 0.0 || right_px(entry, series) <= width_px + 1e-9);
      if (i == 0) continue;
      const LegendEntry& before = sut.entries[i - 1];
      ASSERT_GT(entry.series, before.series);
      if (entry.middle_px == before.middle_px) {
        ASSERT_GT(entry.left_px, right_px(before, series));
      } else {
        ASSERT_EQ(entry.left_px, 0.0);
        ASSERT_DOUBLE_EQ(entry.middle_px - before.middle_px, kLegendRow_px);
        // Two entries of a row are less than 20 px apart.
        ASSERT_GT(right_px(before, series) + 20.0 + right_px(entry, series), width_px);
      }
    }
    ASSERT_DOUBLE_EQ(sut.width_px, widest_px);
    ASSERT_EQ(sut.rows == 0, sut.entries.empty());
  }
}

TEST(LegendLayoutTest, AMovedBlockKeepsItsShape) {
  const LegendBlock block = flow_legend(labelled({"aaa", "bbb", "ccc"}), 100.0);
  const auto sut = moved(block, 10.0, -5.0);
  ASSERT_EQ(sut.size(), block.entries.size());
  for (std::size_t i = 0; i < sut.size(); ++i) {
    EXPECT_EQ(sut[i].series, block.entries[i].series);
    EXPECT_DOUBLE_EQ(sut[i].left_px, block.entries[i].left_px + 10.0);
    EXPECT_DOUBLE_EQ(sut[i].middle_px, block.entries[i].middle_px - 5.0);
  }
}

}  // namespace stillhand::report::legend_layout_test
