// SPDX-License-Identifier: Apache-2.0
// What gnuplot is told of series, legends, lines and notes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/report/plot/marks_script.hpp"
#include "apps/libraries/report/plot/series_script.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report::scripts_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr Canvas kCanvas{1000.0, 1000.0};

// From 0 to 10 on both axes, a unit is 80 px.
PanelLayout layout() {
  PanelLayout out;
  out.plot = {100.0, 100.0, 900.0, 900.0};
  out.x.high = out.y.high = 10.0;
  return out;
}

Series of(Kind kind) {
  return {.kind = kind,
          .x = {1, 2},
          .y = {3, 4},
          .y_low = {2, 3.5},
          .y_high = {5, 6},
          .boxes = {{4, 0.5, 1, 1.5, 2, 2.5}},
          .line_width_px = 2.0,
          .point_size = 2.0};
}

std::string rows(const Series& series) {
  const std::string data = series_script(series, layout(), "$p").data;
  return data.substr(10, data.size() - 14);  // between "$p << EOD\n" and "EOD\n"
}

TEST(SeriesScriptTest, EachKindHasItsColumnsAndItsStyle) {
  const auto clauses = [](Kind kind) { return series_script(of(kind), layout(), "$p").clauses; };
  EXPECT_EQ(rows(of(Kind::kLine)), "1 3\n2 4\n");
  EXPECT_THAT(clauses(Kind::kLine),
              ElementsAre("$p using 1:2 with lines lw 2 lc rgb '#808080' dt solid"));
  EXPECT_THAT(clauses(Kind::kDashedLine),
              ElementsAre(HasSubstr("lines lw 2 lc rgb '#808080' dt (7,4)")));
  EXPECT_THAT(clauses(Kind::kDottedLine), ElementsAre(HasSubstr("dt (1.5,3.5)")));
  EXPECT_THAT(clauses(Kind::kSteps), ElementsAre(HasSubstr("with steps lw 2")));
  EXPECT_THAT(clauses(Kind::kPoints),
              ElementsAre("$p using 1:2 with points pt 7 ps 1.24 lc rgb '#808080'"));
  EXPECT_THAT(
      clauses(Kind::kLineAndPoints),
      ElementsAre("$p using 1:2 with linespoints lw 2 lc rgb '#808080' dt solid pt 7 ps 1.24"));
  EXPECT_EQ(rows(of(Kind::kBand)), "1 2 5\n2 3.5 6\n");
  EXPECT_THAT(clauses(Kind::kBand),
              ElementsAre("$p using 1:2:3 with filledcurves lc rgb '#808080' fillstyle transparent "
                          "solid 0.22 noborder"));
  // An arrow from the lower end, as high as both ends are apart.
  EXPECT_EQ(rows(of(Kind::kErrorBars)), "1 3 2 0 3\n2 4 3.5 0 2.5\n");
  EXPECT_THAT(
      clauses(Kind::kErrorBars),
      ElementsAre(HasSubstr("using 1:3:4:5 with vectors heads fixed size graph 0.004375,90"),
                  HasSubstr("using 1:2 with points")));
  EXPECT_EQ(rows(of(Kind::kBars)), "1 3 0.6\n2 4 0.6\n");
  EXPECT_THAT(clauses(Kind::kBars), ElementsAre(HasSubstr("solid 0.75 border lc rgb '#808080'")));
  EXPECT_EQ(rows(of(Kind::kBox)), "4 0.5 1 1.5 2 2.5 0.6\n");
  EXPECT_THAT(clauses(Kind::kBox),
              ElementsAre(HasSubstr("using 1:3:2:6:5:7 with candlesticks whiskerbars 0.5"),
                          HasSubstr("using 1:4:4:4:4:7 with candlesticks lw 2.6")));
}

TEST(SeriesScriptTest, AGapEndsALineAndIsNoPoint) {
  for (const double gap : std::vector<double>{NAN, INFINITY, 1e101}) {
    Series line{.x = {1, 2, 3, 4, 5}, .y = {1, 2, gap, 4, 5}};
    EXPECT_EQ(rows(line), "1 1\n2 2\n\n4 4\n5 5\n");
    line.kind = Kind::kPoints;
    EXPECT_EQ(rows(line), "1 1\n2 2\n4 4\n5 5\n");
    std::swap(line.x, line.y);
    EXPECT_EQ(rows(line), "1 1\n2 2\n4 4\n5 5\n");
    Series bar = of(Kind::kErrorBars);
    bar.y_high[0] = gap;
    EXPECT_EQ(rows(bar), "2 4 3.5 0 2.5\n");
    for (double Box::* part : {&Box::at, &Box::low, &Box::lower_quartile, &Box::median,
                               &Box::upper_quartile, &Box::high}) {
      Series box = of(Kind::kBox);
      box.boxes[0].*part = gap;
      EXPECT_EQ(series_script(box, layout(), "$p").clauses.size(), 0U);
    }
  }
  EXPECT_EQ(series_script({.x = {1}, .y = {NAN}}, layout(), "$p").clauses.size(), 0U);
}

// 2001 points and more on 800 columns of pixels.
TEST(SeriesScriptTest, LongSeriesAreThinnedExceptBars) {
  Series series;
  for (int i = 0; i < 2001; ++i) {
    series.x.push_back(i * 0.0001);  // 16 columns
    series.y.push_back(i % 2);
  }
  series.y_low = series.y_high = series.y;
  const auto count = [&](Kind kind, std::size_t points = 2001) {
    Series sut = series;
    sut.kind = kind;
    for (auto* each : {&sut.x, &sut.y, &sut.y_low, &sut.y_high}) each->resize(points);
    const std::string text = rows(sut);
    return std::count(text.begin(), text.end(), '\n');
  };
  for (const Kind kind :
       {Kind::kLine, Kind::kDashedLine, Kind::kDottedLine, Kind::kSteps, Kind::kBand}) {
    EXPECT_GT(count(kind), 16 * 2);
    EXPECT_LE(count(kind), 17 * 4);
    EXPECT_EQ(count(kind, 2000), 2000);
  }
  EXPECT_EQ(count(Kind::kPoints), 16 * 2 + 1);  // one in each pixel
  for (const Kind kind : {Kind::kBars, Kind::kErrorBars, Kind::kLineAndPoints}) {
    EXPECT_EQ(count(kind), 2001);
  }
}

// "x y" of each label, in thousandths of the picture from its top left corner, without its backing.
std::vector<std::string> labels(const std::string& script) {
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = script.find("set label ", at)) != std::string::npos; ++at) {
    std::size_t next = script.find("screen ", at) + 7;
    const double x = 1000.0 * std::stod(script.substr(next));
    next = script.find("screen ", next) + 7;
    out.push_back(decimal(x) + " " + decimal(1000.0 - 1000.0 * std::stod(script.substr(next))));
  }
  return out;
}

TEST(MarksScriptTest, ATextStandsAtItsPlace) {
  EXPECT_EQ(kCanvas.at(250.0, 100.0), "screen 0.25,screen 0.9");
  EXPECT_EQ(text_command(kCanvas, "a", 250.0, 100.0, {}),
            "set label 'a' at screen 0.25,screen 0.9 left front noenhanced font 'DejaVu Sans,13' "
            "textcolor rgb '#222222'\n");
  EXPECT_EQ(text_command(kCanvas, "a", 250.0, 100.0, {Anchor::kRight, 11.5, true, 90, "#123456"}),
            "set label 'a' at screen 0.25,screen 0.9 right rotate by 90 front noenhanced font "
            "'DejaVu Sans:Bold,11.5' textcolor rgb '#123456'\n");
}

TEST(MarksScriptTest, ALegendShowsWhatIsDrawn) {
  PanelLayout sut = layout();
  sut.entries = {{0, 100.0, 50.0}};
  const auto legend = [&](Kind kind) {
    Series series = of(kind);
    series.label = "s";
    return legend_script({.series = {series}}, sut, kCanvas);
  };
  const std::string text = "set label 's' at screen 0.13,screen 0.95 left";
  const std::string stroke =
      "set arrow from screen 0.1,screen 0.95 to screen 0.124,screen 0.95 nohead";
  const std::string point = "set label '' at screen 0.112,screen 0.95 front point pt 7 ps 1.24";
  EXPECT_THAT(legend(Kind::kLine),
              AllOf(HasSubstr(text), HasSubstr(stroke), Not(HasSubstr(point))));
  EXPECT_THAT(legend(Kind::kSteps), AllOf(HasSubstr(stroke), Not(HasSubstr(point))));
  EXPECT_THAT(legend(Kind::kPoints), AllOf(HasSubstr(point), Not(HasSubstr("arrow"))));
  EXPECT_THAT(legend(Kind::kLineAndPoints), AllOf(HasSubstr(point), HasSubstr(stroke)));
  EXPECT_THAT(legend(Kind::kErrorBars),
              AllOf(HasSubstr(point), HasSubstr("arrow from screen 0.112,screen 0.957 to screen "
                                                "0.112,screen 0.943 nohead")));
  EXPECT_THAT(legend(Kind::kBand),
              HasSubstr("rectangle from screen 0.1,screen 0.945 to screen 0.124,screen 0.955 front "
                        "fillcolor rgb '#808080' fillstyle transparent solid 0.22 noborder"));
  for (const Kind kind : {Kind::kBars, Kind::kBox}) {
    EXPECT_THAT(legend(kind), HasSubstr("rectangle from screen 0.105,screen 0.945 to screen "
                                        "0.119,screen 0.955 front"));
  }
  EXPECT_THAT(legend(Kind::kBand), Not(HasSubstr("'white'")));
  sut.legend = {110.0, 110.0, 200.0, 140.0};
  EXPECT_THAT(legend(Kind::kLine),
              HasSubstr("rectangle from screen 0.108,screen 0.86 to screen 0.202,screen 0.89 front "
                        "fillcolor rgb 'white'"));
}

TEST(MarksScriptTest, AReferenceLineCrossesThePanelWithItsLabelInside) {
  const double width_px = text_width_px("level", kSmallFontSize_px);
  const auto place = [](double x_px, double y_px) { return decimal(x_px) + " " + decimal(y_px); };
  PanelLayout sut = layout();
  const auto script = [&](std::vector<ReferenceLine> lines) {
    return reference_line_script({.reference_lines = std::move(lines)}, sut, kCanvas);
  };
  const ReferenceLine across{Direction::kHorizontal, 5.0, "level"};
  const ReferenceLine up{Direction::kVertical, 5.0, "level"};
  EXPECT_THAT(script({across}),
              HasSubstr("arrow from screen 0.1,screen 0.5 to screen 0.9,screen 0.5 "
                        "nohead front lw 1.2 dt (5,4)"));
  EXPECT_THAT(labels(script({across})), ElementsAre(place(895.0 - width_px, 492.0)));
  // A second one at the same level has its label at the left end; below the line next to the top.
  EXPECT_THAT(labels(script({across, across})),
              ElementsAre(place(895.0 - width_px, 492.0), place(105.0, 492.0)));
  EXPECT_THAT(labels(script({{Direction::kHorizontal, 9.9, "level"}})),
              ElementsAre(place(895.0 - width_px, 116.0)));
  EXPECT_THAT(script({up}),
              HasSubstr("arrow from screen 0.5,screen 0.1 to screen 0.5,screen 0.9 "));
  // A row lower each where they would collide, and left of the line next to the right edge.
  EXPECT_THAT(labels(script({up, up, up})),
              ElementsAre(place(505.0, 110.0), place(505.0, 125.0), place(505.0, 140.0)));
  EXPECT_THAT(labels(script({{Direction::kVertical, 9.9, "level"}})),
              ElementsAre(place(887.0 - width_px, 110.0)));
  EXPECT_THAT(labels(script({{Direction::kVertical, 0.0, std::string(200, 'm')}})),
              ElementsAre("102 110"));
  sut.legend = {500.0, 100.0, 600.0, 120.0};
  EXPECT_THAT(labels(script({up})), ElementsAre(place(505.0, 140.0)));
  for (const double outside : {-0.1, 10.1, static_cast<double>(NAN)}) {
    EXPECT_EQ(script({{Direction::kHorizontal, outside, "a"}}), "");
    EXPECT_EQ(script({{Direction::kVertical, outside, "a"}}), "");
  }
  EXPECT_NE(script({{Direction::kHorizontal, 0.0, ""}}), "");
  EXPECT_NE(script({{Direction::kHorizontal, 10.0, ""}}), "");
}

TEST(MarksScriptTest, NotesStackInTheirCornersAndStandNextToTheirPoints) {
  PanelLayout sut = layout();
  const auto script = [&](std::vector<Note> notes) {
    return note_script({.notes = std::move(notes)}, sut, kCanvas);
  };
  const Note top_left{"a", Corner::kTopLeft};
  const Note top_right{"a", Corner::kTopRight};
  const Note bottom_left{"a", Corner::kBottomLeft};
  const Note bottom_right{"a", Corner::kBottomRight};
  EXPECT_THAT(labels(script({top_left, top_left, top_right})),
              ElementsAre("110 114.5", "110 131.5", "890 114.5"));
  EXPECT_THAT(labels(script({bottom_left, bottom_left, bottom_right})),
              ElementsAre("110 868.5", "110 885.5", "890 885.5"));
  EXPECT_THAT(script({top_right}), HasSubstr(" right front"));
  EXPECT_THAT(script({top_left}), HasSubstr(" left front"));
  // Below or above a legend in the same corner.
  sut.legend = {100.0, 100.0, 200.0, 130.0};
  sut.legend_place = Legend::kTopLeft;
  EXPECT_THAT(labels(script({top_left, top_right})), ElementsAre("110 148.5", "890 114.5"));
  sut.legend_place = Legend::kBottomRight;
  EXPECT_THAT(labels(script({bottom_right, bottom_left})), ElementsAre("890 851.5", "110 885.5"));
  sut.legend = {};
  const auto at = [&](double x, double y) {
    return labels(script({{"a", Corner::kBottomLeft, std::pair{x, y}}, bottom_left}));
  };
  EXPECT_THAT(at(5.0, 5.0), ElementsAre("508 500", "110 885.5"));
  EXPECT_THAT(at(10.0, 0.0), ElementsAre("892 900", "110 885.5"));
  EXPECT_THAT(at(10.1, 5.0), ElementsAre("110 885.5"));
  EXPECT_THAT(at(5.0, -0.1), ElementsAre("110 885.5"));
}

}  // namespace stillhand::report::scripts_test
