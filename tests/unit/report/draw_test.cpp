// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/draw.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "apps/libraries/report/plot/gnuplot_script.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::report::draw_test {

using test::every_kind;
using test::one_line;
using test::strokes;
using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Drawing drawn(const Figure& figure) { return draw({&figure, 1}).front(); }

// Pixels of a PNG: width and height stand in its first chunk, big-endian.
std::pair<std::uint32_t, std::uint32_t> size_of(const std::string& png) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i)
      value = value << 8 | static_cast<std::uint8_t>(png[i]);
    return value;
  };
  return {word(16), word(20)};
}

std::size_t count(const std::string& text, char letter) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), letter));
}

TEST(DrawTest, EveryKindOfSeriesIsInAWellFormedSvgInItsOwnColour) {
  const Figure figure = every_kind();
  const Drawing sut = drawn(figure);
  EXPECT_TRUE(test::well_formed(sut.svg));
  for (const Series& series : figure.panels[0].series) {
    // In the legend, and at least once more: the data.
    const std::string colour = test::svg_colour(series.colour);
    const std::size_t first = sut.svg.find(colour);
    ASSERT_NE(first, std::string::npos) << series.label;
    EXPECT_NE(sut.svg.find(colour, first + 1), std::string::npos) << series.label;
    EXPECT_THAT(sut.svg, HasSubstr("<text>" + series.label + "</text>"));
  }
}

TEST(DrawTest, ThePngHasTwiceThePixels) {
  const Figure figure = every_kind();
  const auto [width, height] = size_of(drawn(figure).png);
  EXPECT_EQ(width, 2U * static_cast<unsigned>(figure.width_px));
  EXPECT_EQ(height, 2U * static_cast<unsigned>(figure.height_px));
}

TEST(DrawTest, TheSameFiguresGiveTheSameBytes) {
  const Drawing first = drawn(every_kind());
  const Drawing second = drawn(every_kind());
  EXPECT_EQ(first.svg, second.svg);
  EXPECT_EQ(first.png, second.png);
}

TEST(DrawTest, AGapLeavesAHoleInTheLine) {
  for (const double gap : {kNan, std::numeric_limits<double>::infinity(), -1e300}) {
    const auto whole = strokes(drawn(one_line({1, 2, 3, 2, 1})).svg, Colour::kConditionA);
    const auto broken = strokes(drawn(one_line({1, 2, gap, 2, 1})).svg, Colour::kConditionA);
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_EQ(count(whole[0], 'M'), 1U);
    EXPECT_EQ(count(whole[0], 'L'), 4U);
    std::string pieces;
    for (const std::string& piece : broken) pieces += piece;
    EXPECT_EQ(count(pieces, 'M'), 2U);
    EXPECT_EQ(count(pieces, 'L'), 2U);
  }
}

TEST(DrawTest, EveryKindStandsGapsAndEmptinessAndLogarithmicAxes) {
  std::vector<Figure> figures;
  for (const Scale scale : {Scale::kLinear, Scale::kLogarithmic, Scale::kDegrees}) {
    for (const std::vector<double>& y :
         {std::vector<double>{}, {kNan, kNan, kNan}, {kNan, 1.0, kNan}, {-1.0, 0.0, 2.0}}) {
      Figure figure = every_kind();
      figure.name = "f" + std::to_string(figures.size());
      figure.panels[0].y.scale = scale;
      figure.panels[0].x.scale =
          scale == Scale::kLogarithmic ? Scale::kLogarithmic : Scale::kLinear;
      for (Series& series : figure.panels[0].series) {
        series.x.resize(y.size());
        series.y = series.y_low = series.y_high = y;
        for (Box& box : series.boxes) box.median = y.empty() ? kNan : y[0];
      }
      figures.push_back(figure);
    }
  }
  for (const Drawing& sut : draw(figures)) EXPECT_TRUE(test::well_formed(sut.svg)) << sut.name;
}

TEST(DrawTest, APanelWithNothingToShowSaysSo) {
  EXPECT_THAT(drawn(one_line({kNan, kNan})).svg, HasSubstr("no data"));
  EXPECT_THAT(drawn({.name = "bare", .panels = {Panel{}}}).svg, HasSubstr("no data"));
  EXPECT_THAT(drawn(one_line({1, 2})).svg, Not(HasSubstr("no data")));
}

TEST(DrawTest, ALongLineIsThinnedAndItsPeakStays) {
  std::vector<double> y(200'000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::sin(0.37 * static_cast<double>(i));
  y[123'457] = 5.0;
  const Figure figure = one_line(y);
  const std::string sut = script_of(figure).data;
  EXPECT_THAT(sut, HasSubstr("\n123457 5\n"));
  // At most four points for each pixel of width.
  EXPECT_LT(count(sut, '\n'), 4U * static_cast<unsigned>(figure.width_px));
}

TEST(DrawTest, AHostileTextIsDrawnAndNothingElse) {
  const test::TemporaryFolder folder;
  const std::string trap = (folder.path() / "trap").string();
  const std::string hostile = "$(touch " + trap + ") `touch " + trap + "` '; system('touch " +
                              trap + "')\nsystem('touch " + trap + "') \" # @x %s <script>\\";
  // How the text has to stand in the SVG: the line break is a space, < and > cannot open a tag.
  std::string expected = hostile;
  expected.replace(expected.find('\n'), 1, " ");
  expected.replace(expected.find('<'), 1, "&lt;");
  Figure figure = every_kind();
  Panel& panel = figure.panels[0];
  panel.title = panel.x.label = panel.y.label = panel.series[0].label = hostile;
  panel.notes[0].text = panel.notes[1].text = hostile;
  panel.reference_lines[0].label = panel.reference_lines[1].label = hostile;
  panel.x.ticks = {{1.0, hostile}, {2.0, hostile}};
  const Drawing sut = drawn(figure);
  EXPECT_TRUE(test::well_formed(sut.svg));
  EXPECT_EQ(folder.entries(), 0U);
  std::size_t found = 0;
  for (std::size_t at = 0; (at = sut.svg.find(expected, at)) != std::string::npos; ++at) ++found;
  EXPECT_EQ(found, 10U);
}

TEST(DrawTest, RenderWritesTheThreeFilesOfEachFigureAndNothingElse) {
  const test::TemporaryFolder folder;
  std::vector<Figure> figures{every_kind(), one_line({1, 2}), one_line({2, 1})};
  figures[2].name = "another";
  const auto sut = render(figures, folder.path());
  EXPECT_EQ(folder.entries(), 9U);
  for (std::size_t i = 0; i < figures.size(); ++i) {
    EXPECT_EQ(sut[i].name, figures[i].name);
    EXPECT_EQ(support::text_of(folder / (figures[i].name + ".svg")), sut[i].svg);
  }
}

TEST(DrawTest, AFolderThatIsNotThereIsNamedInTheError) {
  const Figure figure = one_line({1, 2});
  const auto draw_there = [&figure] { render({&figure, 1}, "/nonexistent/folder"); };
  EXPECT_THAT(support::refusal<std::runtime_error>(draw_there),
              HasSubstr("/nonexistent/folder/one_line.svg"));
}

TEST(DrawTest, NoFiguresNeedNoGnuplot) { EXPECT_TRUE(draw({}).empty()); }

TEST(DrawDeathTest, ANameThatIsNoFileStemIsABug) {
  Figure figure = one_line({1, 2});
  figure.name = "../x";
  EXPECT_DEATH(draw({&figure, 1}), "good_name");
}

TEST(DrawDeathTest, ArraysOfUnequalLengthAreABug) {
  Figure figure = one_line({1, 2});
  figure.panels[0].series[0].x.pop_back();
  EXPECT_DEATH(draw({&figure, 1}), "size");
}

}  // namespace stillhand::report::draw_test
