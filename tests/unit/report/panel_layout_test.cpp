// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/panel_layout.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/report/plot/gnuplot_script.hpp"
#include "apps/libraries/report/plot/legend_layout.hpp"
#include "apps/libraries/report/plot/marks_script.hpp"
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

testing::Matcher<std::vector<double>> near(const std::vector<double>& places_px) {
  return testing::Pointwise(testing::DoubleNear(1e-4), places_px);
}

std::vector<double> sides_of(const Rectangle& box) {
  return {box.left, box.top, box.right, box.bottom};
}

// Of 500 px in height, with ticks of known labels and without a legend.  6 px of edge, 18 between
// columns, 12 between rows, 16 right of a plot; so a column has (860 - 12 - 18)/2 = 415.  Above a
// plot are 24 px with a title, 8 without; below it 24, with an x label 43.
TEST(PanelLayoutTest, PlotsFillThePictureButForTheirMargins) {
  Figure asked = figure(2, 3);
  for (Panel& each : asked.panels) {
    each.legend = Legend::kNone;
    each.x.ticks = {{0.0, "0"}, {1.0, "1"}};
    each.y.ticks = {{0.0, "low"}, {1.0, "1"}};
    each.title = each.x.label = "";
  }
  asked.panels[0].title = "Title";
  asked.panels[0].x.label = "time [s]";
  asked.panels[2].y.ticks[1].label = "highest";
  const auto sut = lay_out(asked);
  const auto width_px = [](const char* text) { return text_width_px(text, kFontSize_px); };
  // The y label has 21, from labels to axis are 9, and 3.
  const double first_px = 39.0 + width_px("highest");
  const double second_px = 472.0 + width_px("low");
  // 500 - 2 * 6 - 12 - 24 - 43 - 8 - 24 = 377 for two plots.
  EXPECT_THAT(sides_of(sut[0].plot), near({first_px, 30.0, 405.0, 218.5}));
  EXPECT_THAT(sides_of(sut[1].plot), near({second_px, 30.0, 838.0, 218.5}));
  EXPECT_THAT(sides_of(sut[2].plot), near({first_px, 281.5, 405.0, 470.0}));
  // Middles of the y and x labels' 21 px and of the title's 19, 4 above the plot.
  EXPECT_THAT((std::vector{sut[0].y_label_px, sut[1].y_label_px, sut[2].y_label_px}),
              near({30.0 - 11.55, 463.0 - 11.55, 30.0 - 11.55}));
  EXPECT_THAT((std::vector{sut[0].x_label_px, sut[0].title_px}), near({251.0, 16.5}));
}

// Also of a picture that has no room for it.
TEST(PanelLayoutTest, APlotHasThirtyPixelsEachWay) {
  Figure asked = figure(1, 1);
  asked.width_px = asked.height_px = 60;
  const Rectangle plot = lay_out(asked)[0].plot;
  EXPECT_NEAR(plot.right - plot.left, 30.0, 1e-9);
  EXPECT_NEAR(plot.bottom - plot.top, 30.0, 1e-9);
}

// The rows of a legend are 19 px; above a plot it is 4 px from it, and the title shares its row
// where both have room.  In a corner it is 8 and 6 px from the axes.
TEST(PanelLayoutTest, ALegendHasItsPlaceAboveOrInACorner) {
  Figure asked = figure(1, 1);
  const LegendBlock row = flow_legend(asked.panels[0].series, 700.0);
  const LegendBlock column = flow_legend(asked.panels[0].series, 0.0);
  const auto laid = [&] {  // top of the plot, the first entry, the title
    const PanelLayout sut = lay_out(asked)[0];
    return std::vector{sut.plot.top, sut.entries[0].left_px, sut.entries[0].middle_px,
                       sut.title_px};
  };
  const Rectangle plot = lay_out(asked)[0].plot;
  EXPECT_THAT(laid(), near({30.0, plot.right - row.width_px, 16.5, 16.5}));
  asked.panels[0].title = std::string(100, 'm');
  EXPECT_THAT(laid(), near({6.0 + 24.0 + 19.0 + 4.0, plot.left, 39.5, 20.0}));
  asked.panels[0].title = "";
  EXPECT_THAT(laid(), near({6.0 + 2.0 + 19.0 + 4.0, plot.left, 17.5, -2.0}));
  // In a corner a row for each entry, with 7 px at each side and 3 px above and below.
  const double width_px = column.width_px + 14.0, height_px = 2.0 * 19.0 + 6.0;
  asked.panels[0].legend = Legend::kTopLeft;
  PanelLayout sut = lay_out(asked)[0];
  EXPECT_THAT(sides_of(sut.legend),
              near({plot.left + 8.0, 20.0, plot.left + 8.0 + width_px, 20.0 + height_px}));
  EXPECT_THAT((std::vector{sut.entries[1].left_px, sut.entries[1].middle_px, sut.title_px}),
              near({plot.left + 15.0, 51.5, 0.5}));
  asked.panels[0].legend = Legend::kBottomRight;
  sut = lay_out(asked)[0];
  EXPECT_THAT(sides_of(sut.legend),
              near({plot.right - 8.0 - width_px, sut.plot.bottom - 6.0 - height_px,
                    plot.right - 8.0, sut.plot.bottom - 6.0}));
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
};
// What the script of a figure letters.
struct Marks {
  std::vector<Text> texts;

  explicit Marks(const Figure& figure) {
    std::istringstream script(script_of(figure).body);
    for (std::string line; std::getline(script, line);) {
      const std::vector<double> at = places_in(line, figure);
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
      texts.push_back({words, box});
    }
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
      for (const PanelLayout& at : lay_out(asked)) ASSERT_EQ(at.legend_place, legend);
      for (std::size_t i = 0; i < sut.texts.size(); ++i) {
        const auto& [words, box] = sut.texts[i];
        ASSERT_TRUE(box.left >= 0.0 && box.right <= asked.width_px && box.top >= 0.0 &&
                    box.bottom <= asked.height_px)
            << words;
        for (std::size_t k = 0; k < i; ++k) {
          const Rectangle& other = sut.texts[k].box;
          ASSERT_FALSE(box.left < other.right && other.left < box.right && box.top < other.bottom &&
                       other.top < box.bottom)
              << words << " and " << sut.texts[k].words;
        }
      }
    }
  }
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
  asked.panels[0].equal_aspect = false;
  const Rectangle whole = lay_out(asked)[0].plot;
  EXPECT_NEAR(sut.plot.left + sut.plot.right, whole.left + whole.right, 1e-9);
  EXPECT_EQ(sut.plot.top, whole.top);
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
  // 14 px above the slanted labels, 6 and those of the axis' label below them.
  EXPECT_NEAR(sut[0].x_label_px, sut[0].plot.bottom + 14.0 + hang_px + 6.0 + 19.0 - 10.5, 1e-9);
}

// A panel whose plot is from (100, 100) to (900, 500) in a picture of 1000 px, a unit 100 px; and
// the places that its marks have, x and y in turn.
struct Marked {
  Panel panel;
  PanelLayout layout;
  std::vector<double> expected;

  Marked() {
    layout.plot = {100.0, 100.0, 900.0, 500.0};
    layout.x.high = 8.0;
    layout.y.high = 4.0;
  }
  void expect(const std::vector<double>& places_px) {
    expected.insert(expected.end(), places_px.begin(), places_px.end());
  }
  void compare(const auto& script_of) const {
    EXPECT_THAT(places_in(script_of(panel, layout, Canvas{1000.0, 1000.0}),
                          {.width_px = 1000, .height_px = 1000}),
                near(expected));
  }
};

// With 2 px of veil on both sides of a text.
TEST(MarksScriptTest, AReferenceLineHasItsLabelInsideAndClearOfOthers) {
  using enum Direction;
  Marked sut;
  const double w = text_width_px("label", kSmallFontSize_px);
  const auto add = [&](Direction direction, double at, double at_px, double left, double middle) {
    sut.panel.reference_lines.push_back({direction, at, "label"});
    if (direction == kHorizontal) sut.expect({100, at_px, 900, at_px});
    if (direction == kVertical) sut.expect({at_px, 500, at_px, 100});
    sut.expect({left - 2, middle + 7, left + w + 2, middle - 7, left, middle});
  };
  add(kHorizontal, 1.0, 400.0, 895.0 - w, 392.0);
  add(kHorizontal, 1.0625, 393.75, 105.0, 385.75);  // the right end is taken
  add(kHorizontal, 0.0, 500.0, 895.0 - w, 492.0);
  add(kHorizontal, 3.84375, 115.625, 895.0 - w, 107.625);
  add(kHorizontal, 3.875, 112.5, 105.0, 120.5);  // above it there is no room
  add(kVertical, 2.0, 300.0, 305.0, 110.0);
  add(kVertical, 2.0625, 306.25, 311.25, 125.0);
  add(kVertical, 4.0, 500.0, 505.0, 110.0);
  add(kVertical, 8.0, 900.0, 895.0 - w, 125.0);  // under the level's label
  for (const Direction each : {kHorizontal, kVertical}) {
    sut.panel.reference_lines.push_back({each, -0.125, "outside"});
    sut.panel.reference_lines.push_back({each, 8.125, "outside"});
  }
  sut.compare(reference_line_script);
}

// Rows of 17 px begin 6 px from the axis, and 4 px from a legend.
TEST(MarksScriptTest, NotesStandInTheirCornersOrAtTheirPoints) {
  using enum Corner;
  Marked sut;
  sut.layout.legend_place = Legend::kTopRight;
  sut.layout.legend = {700.0, 106.0, 892.0, 150.0};
  const double w = text_width_px("note", kSmallFontSize_px);
  const auto add = [&](const Note& note, double left, double anchor, double middle) {
    sut.panel.notes.push_back(note);
    sut.expect({left - 2, middle + 8, left + w + 2, middle - 8, anchor, middle});
  };
  add({"note", kTopLeft}, 110.0, 110.0, 114.5);
  add({"note", kTopLeft}, 110.0, 110.0, 131.5);
  add({"note", kTopRight}, 890.0 - w, 890.0, 162.5);
  add({"note", kBottomLeft}, 110.0, 110.0, 468.5);
  add({"note", kBottomLeft}, 110.0, 110.0, 485.5);
  add({"note", kBottomRight}, 890.0 - w, 890.0, 485.5);
  add({"note", {}, std::pair{2.0, 1.0}}, 308.0, 308.0, 400.0);
  add({"note", {}, std::pair{8.0, 4.0}}, 892.0 - w, 892.0, 100.0);
  sut.panel.notes.push_back({"outside", {}, std::pair{8.125, 1.0}});
  sut.panel.notes.push_back({"outside", {}, std::pair{2.0, -0.125}});
  sut.compare(note_script);
}

// From x = 200 in the row of y = 300: 24 px for the mark, 30 to the text.
TEST(MarksScriptTest, ALegendShowsAMarkOfEachKind) {
  Marked sut;
  const auto add = [&](Kind kind, const std::vector<double>& mark) {
    sut.layout.entries.push_back({sut.panel.series.size(), 200.0, 300.0});
    sut.panel.series.push_back(Series{.label = "series", .kind = kind});
    sut.expect(mark);
    sut.expect({230, 300});
  };
  add(Kind::kLine, {200, 300, 224, 300});
  add(Kind::kPoints, {212, 300});
  add(Kind::kLineAndPoints, {200, 300, 224, 300, 212, 300});
  add(Kind::kErrorBars, {212, 293, 212, 307, 212, 300});
  add(Kind::kBand, {200, 305, 224, 295});
  add(Kind::kBars, {205, 305, 219, 295});
  add(Kind::kBox, {205, 305, 219, 295});
  sut.compare(legend_script);
}

}  // namespace stillhand::report::panel_layout_test
