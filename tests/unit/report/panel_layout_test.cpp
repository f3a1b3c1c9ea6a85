// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/panel_layout.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report::panel_layout_test {

Panel panel(const std::string& title, double high) {
  Panel result{.title = title};
  result.x.label = "time [s]";
  result.y.label = "force [N]";
  result.series = {Series{.label = "measured", .x = {0, 1}, .y = {0, high}},
                   Series{.label = "model", .x = {0, 1}, .y = {0, high}}};
  return result;
}

Figure figure(int columns, std::size_t panels) {
  Figure result{.name = "f", .columns = columns, .width_px = 860, .height_px = 500};
  for (std::size_t i = 0; i < panels; ++i) {
    result.panels.push_back(panel(i % 2 == 0 ? "Title" : "", i % 3 == 0 ? 1.0 : 12345.0));
  }
  return result;
}

TEST(PanelLayoutTest, PlotsOfAColumnShareTheirSidesAndOfARowTheirTop) {
  const auto sut = lay_out(figure(2, 4));
  EXPECT_EQ(sut[0].plot.left, sut[2].plot.left);
  EXPECT_EQ(sut[0].plot.right, sut[2].plot.right);
  EXPECT_EQ(sut[0].plot.top, sut[1].plot.top);
  EXPECT_EQ(sut[0].plot.bottom, sut[1].plot.bottom);
  EXPECT_EQ(sut[0].y_label_px, sut[2].y_label_px);
}

TEST(PanelLayoutTest, EveryPlotHasTheSameHeight) {
  const auto sut = lay_out(figure(1, 3));
  EXPECT_DOUBLE_EQ(sut[0].plot.height(), sut[1].plot.height());
  EXPECT_DOUBLE_EQ(sut[1].plot.height(), sut[2].plot.height());
}

TEST(PanelLayoutTest, EverythingOfAPanelStaysOnThePictureAndClearOfTheNext) {
  for (const int columns : {1, 2, 3}) {
    Figure asked = figure(columns, 6);
    asked.height_px = 200 * 6 / columns;
    const auto sut = lay_out(asked);
    for (std::size_t i = 0; i < sut.size(); ++i) {
      // Half a line of text on each side of its centre.
      EXPECT_GE(sut[i].y_label_px - 6.5, 0.0);
      EXPECT_LE(sut[i].x_label_px + 6.5, asked.height_px);
      EXPECT_GT(sut[i].x_label_px - 6.5, sut[i].plot.bottom + 15.0 + 6.5);  // tick labels
      EXPECT_LE(sut[i].plot.right, asked.width_px);
      const std::size_t below = i + static_cast<std::size_t>(columns);
      if (below < sut.size()) {
        for (const LegendEntry& entry : sut[below].entries) {
          EXPECT_GT(entry.middle_px - 9.0, sut[i].x_label_px + 6.5);
        }
      }
      if ((i + 1) % static_cast<std::size_t>(columns) != 0 && i + 1 < sut.size()) {
        EXPECT_GT(sut[i + 1].y_label_px - 6.5, sut[i].plot.right);
      }
    }
  }
}

TEST(PanelLayoutTest, LegendEntriesDoNotOverlapAndStayAboveThePlot) {
  Figure asked = figure(1, 1);
  asked.panels[0].series.clear();
  for (int i = 0; i < 15; ++i) {
    asked.panels[0].series.push_back(
        Series{.label = "a rather long label " + std::to_string(i), .x = {0, 1}, .y = {0, 1}});
  }
  const PanelLayout sut = lay_out(asked)[0];
  ASSERT_EQ(sut.entries.size(), 15U);
  for (std::size_t i = 0; i < sut.entries.size(); ++i) {
    const LegendEntry& entry = sut.entries[i];
    const double width_px =
        kSampleToText_px + text_width_px(asked.panels[0].series[i].label, kFontSize_px);
    EXPECT_LE(entry.left_px + width_px, sut.plot.right);
    EXPECT_LT(entry.middle_px + 6.5, sut.plot.top);
    EXPECT_GT(entry.middle_px - 6.5, sut.title_px + 6.5);
    if (i > 0 && sut.entries[i - 1].middle_px == entry.middle_px) {
      EXPECT_GT(entry.left_px, sut.entries[i - 1].left_px + width_px);
    }
  }
}

TEST(PanelLayoutTest, SeriesWithoutALabelOrToldNotToHaveNoLegendEntry) {
  Figure asked = figure(1, 1);
  asked.panels[0].series[0].show_in_legend = false;
  asked.panels[0].series.push_back(Series{.x = {0, 1}, .y = {0, 1}});
  const PanelLayout sut = lay_out(asked)[0];
  ASSERT_EQ(sut.entries.size(), 1U);
  EXPECT_EQ(sut.entries[0].series, 1U);
}

TEST(PanelLayoutTest, ALegendThatWouldFillASmallPlotGoesAboveIt) {
  Figure asked = figure(4, 4);
  for (Panel& small : asked.panels) {
    small.legend = Legend::kTopRight;
    small.series[0].label = "a label that needs most of a narrow plot";
  }
  EXPECT_EQ(lay_out(asked)[0].legend_place, Legend::kAbove);
  asked.columns = 1;
  asked.height_px = 1600;
  const PanelLayout roomy = lay_out(asked)[0];
  EXPECT_EQ(roomy.legend_place, Legend::kTopRight);
  EXPECT_LT(roomy.legend.right, roomy.plot.right);
  EXPECT_GT(roomy.legend.left, roomy.plot.left);
}

TEST(PanelLayoutTest, AUnitIsAsLongOnXAsOnYWhereAsked) {
  Figure asked = figure(1, 1);
  asked.panels[0].equal_aspect = true;
  asked.panels[0].x = {.low = -10.0, .high = 10.0};
  asked.panels[0].y = {.low = -5.0, .high = 10.0};
  const PanelLayout sut = lay_out(asked)[0];
  EXPECT_NEAR(sut.plot.width() / 20.0, sut.plot.height() / 15.0, 1e-9);
}

TEST(PanelLayoutTest, CategoriesThatDoNotFitSideBySideAreSlantedAndHaveRoomBelow) {
  Figure asked = figure(2, 2);
  const std::string name = "nonlinear_stiffness";
  for (int i = 0; i < 6; ++i) {
    asked.panels[0].x.ticks.push_back({0.2 * i, name});
  }
  const auto sut = lay_out(asked);
  EXPECT_TRUE(sut[0].slanted_x_labels);
  EXPECT_FALSE(sut[1].slanted_x_labels);
  const double hang_px = 0.5 * text_width_px("nonlinear_stiffness", kFontSize_px);
  EXPECT_GT(sut[0].x_label_px - 6.5, sut[0].plot.bottom + 10.0 + hang_px);
}

}  // namespace stillhand::report::panel_layout_test
