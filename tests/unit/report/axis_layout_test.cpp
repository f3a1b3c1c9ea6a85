// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/axis_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "apps/libraries/report/plot/panel_layout.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::report::axis_layout_test {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

AxisLayout horizontal(const Axis& axis, double low = 0.0, double high = 1.0,
                      double length_px = 700.0) {
  return lay_out_axis(axis, {.low = low, .high = high}, length_px, true, true, kFontSize_px);
}

AxisLayout vertical(const Axis& axis, double low, double high) {
  return lay_out_axis(axis, {.low = low, .high = high}, 200.0, false, false, kFontSize_px);
}

std::vector<std::string> labels(const AxisLayout& layout) {
  std::vector<std::string> result;
  for (const AxisTick& tick : layout.major) result.push_back(tick.label);
  return result;
}

TEST(AxisLayoutTest, LimitsAndLabelsSuitTheScaleAndWhatIsGiven) {
  struct Case {
    AxisLayout sut;
    double low, high;
    std::vector<std::string> labels;
  };
  const Axis frequency{.scale = Scale::kLogarithmic};
  for (const Case& each :
       std::vector<Case>{// A line against time fills its axis exactly.
                         {horizontal({}, 40.0, 60.0),
                          40.0,
                          60.0,
                          {"40", "42", "44", "46", "48", "50", "52", "54", "56", "58", "60"}},
                         {horizontal(frequency, 0.1, 10.0),
                          0.1,
                          10.0,
                          {"0.1", "0.2", "0.5", "1", "2", "5", "10"}},
                         // Where there is no room, powers alone, and of many decades every second.
                         {horizontal(frequency, 0.1, 10.0, 150.0), 0.1, 10.0, {"0.1", "1", "10"}},
                         {horizontal(frequency, 1e-4, 1e6, 300.0),
                          1e-4,
                          1e6,
                          {"10⁻⁴", "10⁻²", "10⁰", "10²", "10⁴", "10⁶"}},
                         {vertical({.scale = Scale::kDegrees}, -200.0, -100.0),
                          -225.0,
                          -90.0,
                          {"−225", "−180", "−135", "−90"}},
                         {vertical({.scale = Scale::kDegrees}, -700.0, 0.0),
                          -720.0,
                          180.0,
                          {"−720", "−540", "−360", "−180", "0", "180"}},
                         // 3120/5 degrees end at a multiple of two turns; of 4320/5 are three.
                         {vertical({.scale = Scale::kDegrees}, -3000.0, 0.0),
                          -3600.0,
                          720.0,
                          {"−3240", "−2160", "−1080", "0"}},
                         {vertical({.low = 0.0, .high = 80.0}, 17.0, 63.0),
                          0.0,
                          80.0,
                          {"0", "20", "40", "60", "80"}},
                         // A hundred ticks are a mistake.
                         {vertical({.low = 0.0, .high = 1.0, .tick_step = 0.01}, 0.0, 1.0),
                          0.0,
                          1.0,
                          {"0", "0.2", "0.4", "0.6", "0.8", "1.0"}},
                         {vertical({.low = 0.0, .high = 1.0, .tick_step = 0.25}, 0.0, 1.0),
                          0.0,
                          1.0,
                          {"0", "0.25", "0.50", "0.75", "1.00"}}}) {
    EXPECT_EQ(each.sut.low, each.low) << each.labels[0];
    EXPECT_EQ(each.sut.high, each.high) << each.labels[0];
    EXPECT_EQ(labels(each.sut), each.labels);
  }
  EXPECT_THAT(labels(vertical(frequency, 1.1e-6, 0.9)),
              ElementsAre("10⁻⁶", "10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "10⁰"));
  const AxisLayout ticks = horizontal(frequency, 0.01, 10.0);
  for (const AxisTick& tick : ticks.major) EXPECT_EQ(tick.at, std::stod(tick.label));
  EXPECT_EQ(ticks.minor.size(), 3 * 6U) << "3, 4, 6, 7, 8, 9 of each decade";
  // A decade of 30 px has no lines within it.
  EXPECT_THAT(horizontal(frequency, 1e-4, 1e6, 300.0).minor,
              ElementsAre(1e-3, 0.1, 10.0, 1e3, 1e5));
}

// 6 % of the span on both sides, of its logarithm too, and 3 % along an axis of marks; none below
// what stands on zero.
TEST(AxisLayoutTest, ThereIsRoomBeyondTheValuesUnlessAlongALine) {
  const AxisLayout linear = vertical({}, 0.0, 10.0);
  EXPECT_NEAR(linear.high, 10.6, 1e-12);
  EXPECT_NEAR(-linear.low, linear.high - 10.0, 1e-12);
  const AxisLayout logarithmic = vertical({.scale = Scale::kLogarithmic}, 1.0, 1e10);
  EXPECT_NEAR(std::log10(logarithmic.high), linear.high, 1e-9);
  EXPECT_NEAR(std::log10(logarithmic.low), linear.low, 1e-9);
  const Extent bars{.low = 0.0, .high = 10.0, .marks = true, .from_zero = true};
  EXPECT_EQ(lay_out_axis({}, bars, 200.0, false, false, kFontSize_px).low, 0.0);
  EXPECT_EQ(lay_out_axis({}, bars, 200.0, false, false, kFontSize_px).high, linear.high);
  EXPECT_NEAR(lay_out_axis({}, bars, 700.0, true, true, kFontSize_px).high, 10.3, 1e-12);
}

TEST(AxisLayoutTest, LessThanADecadeOnALogarithmicAxisStillHasTwoTicks) {
  const AxisLayout sut = vertical({.scale = Scale::kLogarithmic}, 3.1, 3.9);
  EXPECT_GE(sut.major.size(), 2U);
}

TEST(AxisLayoutTest, CategoriesReplaceNumbersAndThoseOutsideAreLeftOut) {
  const AxisLayout sut = horizontal({.ticks = {{1.0, "A"}, {2.0, "B"}, {9.0, "far"}}}, 0.5, 2.5);
  EXPECT_THAT(labels(sut), ElementsAre("A", "B"));
  EXPECT_TRUE(sut.categories);
}

TEST(AxisLayoutTest, LabelsSideBySideDoNotTouch) {
  for (const double length_px : {60.0, 120.0, 200.0, 400.0, 800.0}) {
    for (const double high : {0.003, 7.0, 1e4, 3e8}) {
      const AxisLayout sut = horizontal({}, -high, high, length_px);
      // Two ticks may always stay, however short the axis.
      for (std::size_t i = 1; i < sut.major.size() && sut.major.size() > 2; ++i) {
        const double apart_px =
            (sut.fraction(sut.major[i].at) - sut.fraction(sut.major[i - 1].at)) * length_px;
        const double need_px = 0.5 * (text_width_px(sut.major[i].label, kFontSize_px) +
                                      text_width_px(sut.major[i - 1].label, kFontSize_px));
        EXPECT_GT(apart_px, need_px) << length_px << " px, " << high;
      }
    }
  }
}

// Before the 6 % of its span: a tenth, or 1 where it is 0; on a logarithm's axis a factor of 2.
TEST(AxisLayoutTest, ASingleValueHasRoomOnBothSides) {
  const double room = std::pow(4.0, 0.06);
  for (const auto& [sut, low, high] : std::vector<std::tuple<AxisLayout, double, double>>{
           {vertical({}, 5.0, 5.0), 4.5 - 0.06, 5.5 + 0.06},
           {vertical({}, -5.0, -5.0), -5.5 - 0.06, -4.5 + 0.06},
           {vertical({}, 0.0, 0.0), -1.12, 1.12},
           {vertical({.scale = Scale::kLogarithmic}, 5.0, 5.0), 2.5 / room, 10.0 * room}}) {
    EXPECT_NEAR(sut.low, low, 1e-12);
    EXPECT_NEAR(sut.high, high, 1e-12);
  }
}

TEST(AxisLayoutTest, NothingToShowStillGivesAnAxis) {
  for (const Scale scale : {Scale::kLinear, Scale::kLogarithmic, Scale::kDegrees}) {
    const AxisLayout sut = lay_out_axis({.scale = scale}, {}, 200.0, false, false, kFontSize_px);
    EXPECT_LT(sut.low, sut.high);
    EXPECT_GE(sut.major.size(), 2U);
  }
}

TEST(AxisLayoutTest, LimitsThatMakeNoAxisAreOpenedUp) {
  const AxisLayout crossed = vertical({.low = 10.0, .high = 2.0}, 0.0, 1.0);
  EXPECT_DOUBLE_EQ(crossed.low, 5.4);  // a tenth about their centre
  EXPECT_DOUBLE_EQ(crossed.high, 6.6);
  const Axis logarithmic{.scale = Scale::kLogarithmic};
  EXPECT_EQ(horizontal(logarithmic, 1.0, 0.0).low, 0.1);  // of no values
  EXPECT_EQ(horizontal(logarithmic, 1.0, 0.0).high, 10.0);
  // A limit that it cannot show is none; 3 decades below the largest, or a factor of 4 about 0.1.
  EXPECT_EQ(horizontal({.scale = Scale::kLogarithmic, .low = 0.0}, 1.0, 100.0).low, 1.0);
  EXPECT_DOUBLE_EQ(horizontal(logarithmic, -1.0, 5.0).low, 0.005);
  EXPECT_DOUBLE_EQ(horizontal(logarithmic, -2.0, 0.0).low, 0.05);
  EXPECT_DOUBLE_EQ(horizontal(logarithmic, -2.0, 0.0).high, 0.2);
}

TEST(AxisLayoutTest, EveryTickLiesWithinTheLimits) {
  for (const double centre : {0.0, 1e-9, 1.0, 1e6, -1e12}) {
    for (const double span : {1e-3, 1.0, 1e5}) {
      const AxisLayout sut = vertical({}, centre - span, centre + span);
      for (const AxisTick& tick : sut.major) {
        EXPECT_GE(sut.fraction(tick.at), -1e-6);
        EXPECT_LE(sut.fraction(tick.at), 1.0 + 1e-6);
      }
      EXPECT_LE(sut.major.size(), 12U);
    }
  }
}

TEST(ExtentTest, GapsAndWhatALogarithmicAxisCannotShowDoNotCount) {
  Panel panel;
  panel.y.scale = Scale::kLogarithmic;
  panel.series = {Series{.x = {1, 2, 3, 4, 5},
                         .y = {kNan, -1.0, 0.0, 3.0, std::numeric_limits<double>::infinity()}}};
  const Extent extent = extent_y(panel);
  EXPECT_EQ(extent.low, 3.0);
  EXPECT_EQ(extent.high, 3.0);
}

TEST(ExtentTest, OnlyWhatIsVisibleAlongXCountsForY) {
  Panel panel;
  panel.x.low = 2.0;
  panel.x.high = 3.0;
  panel.series = {Series{.x = {1, 2, 3, 4}, .y = {100, 5, 6, -100}}};
  EXPECT_EQ(extent_y(panel).low, 5.0);
  EXPECT_EQ(extent_y(panel).high, 6.0);
}

TEST(ExtentTest, BarsStandOnZeroAndTheirWidthCounts) {
  Panel panel{.series = {Series{.kind = Kind::kBars, .x = {1, 2}, .y = {5, 6}, .bar_width = 0.6}}};
  EXPECT_EQ(extent_y(panel).low, 0.0);
  EXPECT_DOUBLE_EQ(extent_x(panel).low, 0.7);
  EXPECT_DOUBLE_EQ(extent_x(panel).high, 2.3);
}

TEST(ExtentTest, TheWhiskersAndTheWidthOfABoxCountWhereItIsVisible) {
  const std::vector<Box> boxes{{1, -3, 3, 4, 5, 12}, {4, 0, 0, 0, 0, 99}};
  Panel panel{.series = {Series{.kind = Kind::kBox, .boxes = boxes, .bar_width = 2}}};
  EXPECT_EQ(extent_x(panel).low, 0.0);
  EXPECT_EQ(extent_x(panel).high, 5.0);
  panel.reference_lines = {{Direction::kHorizontal, -7.0}, {Direction::kVertical, 6.0}};
  EXPECT_EQ(extent_x(panel).low, 0.0);
  EXPECT_EQ(extent_x(panel).high, 6.0);
  EXPECT_EQ(extent_y(panel).high, 99.0);
  panel.x.low = panel.x.high = 1.0;
  EXPECT_EQ(extent_y(panel).low, -7.0);
  EXPECT_EQ(extent_y(panel).high, 12.0);
}

TEST(ExtentTest, MarksHaveRoomErrorBarsHaveEndsAndTheLargestValueIsStillOne) {
  for (const Kind kind : {Kind::kLine, Kind::kDashedLine, Kind::kDottedLine, Kind::kPoints,
                          Kind::kLineAndPoints, Kind::kErrorBars, Kind::kBars, Kind::kBox}) {
    const Panel panel{.series = {Series{.kind = kind}, Series{}}};
    EXPECT_EQ(extent_x(panel).marks, kind >= Kind::kPoints) << static_cast<int>(kind);
    EXPECT_EQ(extent_y(panel).marks, kind >= Kind::kPoints) << static_cast<int>(kind);
    EXPECT_EQ(extent_y(panel).from_zero, kind == Kind::kBars);
  }
  const Panel longer{.series = {Series{.x = {1}, .y = {2, 9}, .y_low = {1, -9}}}};
  EXPECT_EQ(extent_y(longer).low, 1.0) << "a value without a place";
  EXPECT_EQ(extent_y(longer).high, 2.0);
  const Panel panel{.series = {Series{.x = {1, 2, 3, 4},
                                      .y = {5, -kLargestValue, 1.1 * kLargestValue},
                                      .y_low = {-2 * kLargestValue, 3, 3, 3, 3},
                                      .y_high = {6, 7, 8, kLargestValue, -2 * kLargestValue}}}};
  EXPECT_EQ(extent_x(panel).low, 1.0);
  EXPECT_EQ(extent_x(panel).high, 4.0);
  EXPECT_EQ(extent_y(panel).low, -kLargestValue);
  EXPECT_EQ(extent_y(panel).high, kLargestValue);
}

}  // namespace stillhand::report::axis_layout_test
