// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/legend_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

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

// Rows of 19 px; in a row 18 px are between an entry and the next.
TEST(LegendLayoutTest, EntriesFillTheirRowsInOrder) {
  const auto series = labelled({"aaa", "bbb", "", "mmm", "i"});
  const double w = right_px({0, 0.0, 0.0}, series), wide = right_px({3, 0.0, 0.0}, series);
  const double two_px = flow_legend(labelled({"aaa", "bbb"}), 1e6).width_px;
  EXPECT_DOUBLE_EQ(two_px, 2.0 * w + 18.0);
  const LegendBlock sut = flow_legend(series, two_px);
  EXPECT_EQ(sut.rows, 2);
  EXPECT_EQ(sut.width_px, two_px);
  EXPECT_EQ(flow_legend(series, two_px * (1.0 - 1e-12)).rows, 3);
  EXPECT_EQ(flow_legend(series, 1.0).rows, 4);  // a wider entry has its own row
  std::vector<double> places;
  for (const LegendEntry& each : moved(sut, 10.0, -5.0)) {
    places.insert(places.end(), {static_cast<double>(each.series), each.left_px, each.middle_px});
  }
  EXPECT_THAT(places,
              testing::Pointwise(testing::DoubleEq(), {0.0, 10.0, 4.5, 1.0, 28.0 + w, 4.5,  //
                                                       3.0, 10.0, 23.5, 4.0, 28.0 + wide, 23.5}));
}

}  // namespace stillhand::report::legend_layout_test
