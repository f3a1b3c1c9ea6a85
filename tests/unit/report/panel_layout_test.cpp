// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/panel_layout.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/gnuplot_script.hpp"
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

TEST(PanelLayoutTest, PlotsOfAColumnShareTheirSidesOfARowTheirTopAndAllTheirHeight) {
  const auto sut = lay_out(figure(2, 4));
  EXPECT_EQ(sut[0].plot.left, sut[2].plot.left);
  EXPECT_EQ(sut[0].plot.right, sut[2].plot.right);
  EXPECT_EQ(sut[0].plot.top, sut[1].plot.top);
  EXPECT_EQ(sut[0].plot.bottom, sut[1].plot.bottom);
  EXPECT_EQ(sut[0].y_label_px, sut[2].y_label_px);
  EXPECT_DOUBLE_EQ(sut[0].plot.height(), sut[2].plot.height());
}

// The places behind "screen" in a line of a script, x and y in turn [px] from the top left corner.
std::vector<double> places_in(const std::string& line, const Figure& figure) {
  std::vector<double> out;
  for (std::size_t at = 0; (at = line.find("screen ", at)) != std::string::npos;) {
    const double share = std::stod(line.substr(at += 7));
    out.push_back(out.size() % 2 == 0 ? share * figure.width_px : (1.0 - share) * figure.height_px);
  }
  return out;
}

struct Text {
  std::string words;
  Rectangle box;  // of its letters, without the room between lines
  bool is_small = false;
};
// What the script of a figure letters, and veils behind small letters.
struct Marks {
  std::vector<Text> texts;
  std::vector<Rectangle> veils;

  explicit Marks(const Figure& figure) {
    std::istringstream script(script_of(figure).body);
    for (std::string line; std::getline(script, line);) {
      const std::vector<double> at = places_in(line, figure);
      if (line.find("rgb 'white'") < line.size()) veils.push_back({at[0], at[3], at[2], at[1]});
      if (!line.starts_with("set label '") || line[11] == '\'') continue;
      const std::string words = line.substr(11, line.find('\'', 11) - 11);
      const double size_px = std::stod(line.substr(line.find(',', line.find("font")) + 1));
      const double width_px = text_width_px(words, size_px);
      const double before_px = line.find(" left") < line.size()     ? 0.0
                               : line.find(" centre") < line.size() ? 0.5 * width_px
                                                                    : width_px;
      Rectangle box{at[0] - before_px, at[1] - 5.5, at[0] - before_px + width_px, at[1] + 5.5};
      if (line.find("rotate by 90") < line.size()) {
        box = {at[0] - 5.5, at[1] - before_px, at[0] + 5.5, at[1] - before_px + width_px};
      }
      texts.push_back({words, box, size_px < kFontSize_px});
    }
  }
  [[nodiscard]] const Rectangle& box_of(const std::string& words) const {
    return std::ranges::find(texts, words, &Text::words)->box;
  }
};

// Six panels with every kind of text; four of them have numbers of five digits.
Figure lettered(int columns, Legend legend) {
  Figure out = figure(columns, 6);
  out.height_px = 320 * 6 / columns;
  for (Panel& each : out.panels) {
    const double high = each.series[0].y[1];
    each.legend = legend;
    if (legend == Legend::kAbove) each.series.resize(6, each.series[0]);  // in several rows
    each.reference_lines = {{Direction::kVertical, 0.5, "half"},
                            {Direction::kVertical, 0.502, "second"},
                            {Direction::kVertical, 0.97, "late"},
                            {Direction::kHorizontal, 0.5 * high, "level"},
                            {Direction::kHorizontal, 0.51 * high, "other"}};
    each.notes = {{"first", Corner::kTopLeft},
                  {"next", Corner::kTopLeft},
                  {"above", Corner::kBottomLeft},
                  {"below", Corner::kBottomLeft},
                  {"point", {}, std::pair{0.55, 0.3 * high}}};
  }
  return out;
}

TEST(PanelLayoutTest, NoTextCoversAnotherOrLeavesThePicture) {
  for (const int columns : {1, 2, 3}) {
    for (const Legend legend : {Legend::kAbove, Legend::kTopLeft, Legend::kTopRight,
                                Legend::kBottomLeft, Legend::kBottomRight}) {
      const Figure asked = lettered(columns, legend);
      const Marks sut(asked);
      ASSERT_EQ(std::ranges::count(sut.texts, "next", &Text::words), 6);
      ASSERT_TRUE(std::ranges::any_of(sut.texts, &Text::is_small));
      const std::vector<PanelLayout> layouts = lay_out(asked);
      for (std::size_t i = 0; i < layouts.size(); ++i) {
        const PanelLayout& at = layouts[i];
        ASSERT_EQ(at.legend_place, legend);
        EXPECT_LE(at.plot.right, asked.width_px);
        if (legend == Legend::kAbove) {
          for (const LegendEntry& each : at.entries) EXPECT_LT(each.middle_px + 6.5, at.plot.top);
        } else {
          EXPECT_GT(at.legend.left, at.plot.left);
          EXPECT_LT(at.legend.right, at.plot.right);
        }
        if ((i + 1) % static_cast<std::size_t>(columns) != 0) {
          EXPECT_GT(layouts[i + 1].y_label_px - 6.5, at.plot.right);
        }
      }
      for (std::size_t i = 0; i < sut.texts.size(); ++i) {
        const auto& [words, box, is_small] = sut.texts[i];
        ASSERT_TRUE(box.left >= 0.0 && box.right <= asked.width_px && box.top >= 0.0 &&
                    box.bottom <= asked.height_px)
            << words;
        for (std::size_t k = 0; k < i; ++k) {
          const Rectangle& other = sut.texts[k].box;
          ASSERT_FALSE(box.left < other.right && other.left < box.right && box.top < other.bottom &&
                       other.top < box.bottom)
              << words << " and " << sut.texts[k].words;
        }
        // Lines run behind a small text: a veil of about its size is between.
        ASSERT_TRUE(!is_small || std::ranges::any_of(sut.veils, [&](const Rectangle& veil) {
          return std::abs(veil.top + veil.bottom - box.top - box.bottom) < 1e-3 &&
                 veil.left <= box.left && veil.right >= box.right &&
                 veil.width() < box.width() + 8.0 && veil.height() > 11.0 && veil.height() < 19.0;
        })) << words;
      }
      EXPECT_NEAR(sut.box_of("next").top - sut.box_of("first").top, 17.0, 0.01);
      EXPECT_NEAR(sut.box_of("below").top - sut.box_of("above").top, 17.0, 0.01);
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
