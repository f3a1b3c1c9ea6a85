// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/screen_layout.hpp"

#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display::screen_layout_test {

constexpr double kBox_m = 0.030;
constexpr double kTrack_m = 0.057 - 0.2286 / 2.0;
constexpr double kTiny_m = 1e-15;  // rounding of sums of tenths of a metre

TEST(ScreenLayoutTest, TheBoxIsThirtyMillimetresBetweenLineCentres) {
  const ScreenLayout sut{ScreenConfig{}, kBox_m};
  const auto [left, right, lower, upper] = sut.box(0.04);
  const auto middle_x = [](const Bar& bar) { return (bar.left_m + bar.right_m) / 2.0; };
  const auto middle_y = [](const Bar& bar) { return (bar.bottom_m + bar.top_m) / 2.0; };
  EXPECT_NEAR(middle_x(right) - middle_x(left), 0.030, kTiny_m);
  EXPECT_NEAR(middle_y(upper) - middle_y(lower), 0.030, kTiny_m);
  EXPECT_NEAR((middle_x(right) + middle_x(left)) / 2.0, 0.04, kTiny_m);
  EXPECT_NEAR((middle_y(upper) + middle_y(lower)) / 2.0, kTrack_m, kTiny_m);
}

TEST(ScreenLayoutTest, EveryLineIsOneMillimetreThick) {
  const ScreenLayout sut{ScreenConfig{}, kBox_m};
  const auto [left, right, lower, upper] = sut.box(0.0);
  const auto [across, upright] = sut.cross(0.0);
  for (const Bar& bar : {left, right, upright})
    EXPECT_NEAR(bar.right_m - bar.left_m, 1e-3, kTiny_m);
  for (const Bar& bar : {lower, upper, across})
    EXPECT_NEAR(bar.top_m - bar.bottom_m, 1e-3, kTiny_m);
}

TEST(ScreenLayoutTest, TheSidesMeetInFullCorners) {
  const ScreenLayout sut{ScreenConfig{}, kBox_m};
  const auto [left, right, lower, upper] = sut.box(0.0);
  for (const Bar& bar : {lower, upper}) {
    EXPECT_EQ(bar.left_m, left.left_m);
    EXPECT_EQ(bar.right_m, right.right_m);
  }
  EXPECT_EQ(left.bottom_m, lower.bottom_m);
  EXPECT_EQ(right.top_m, upper.top_m);
}

TEST(ScreenLayoutTest, TheCrossIsCentredOnTheCursorAndInTheBoxesMiddle) {
  const ScreenLayout sut{ScreenConfig{}, kBox_m};
  for (const Bar& bar : sut.cross(-0.07)) {
    EXPECT_NEAR((bar.left_m + bar.right_m) / 2.0, -0.07, kTiny_m);
    EXPECT_NEAR((bar.bottom_m + bar.top_m) / 2.0, kTrack_m, kTiny_m);
  }
  EXPECT_NEAR(sut.cross(0.0)[0].right_m - sut.cross(0.0)[0].left_m, 0.020, kTiny_m);
}

TEST(ScreenLayoutTest, ABoxThatLeavesTheScreenIsRefused) {
  ScreenConfig screen;
  screen.track_above_bottom_m = 0.0154;  // half a box and half a line are 15.5 mm
  EXPECT_THROW(ScreenLayout(screen, kBox_m), ConfigError);
  screen.track_above_bottom_m = 0.0156;
  // The cross's 10 mm are less than the box's 15.5 mm.
  EXPECT_THROW(ScreenLayout(screen, kBox_m), ConfigError);  // below its own range of 20 mm
  screen.track_above_bottom_m = 0.0200;
  EXPECT_NO_THROW(ScreenLayout(screen, kBox_m));
  EXPECT_NO_THROW(ScreenLayout(screen, 0.0385));            // 19.75 mm with half a line
  EXPECT_THROW(ScreenLayout(screen, 0.0395), ConfigError);  // 20.25 mm
}

}  // namespace stillhand::display::screen_layout_test
