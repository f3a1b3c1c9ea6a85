// SPDX-License-Identifier: Apache-2.0
// The cursor follows what a mitigation leaves of the stick's angle, and the raw stick without one.
#include "services/core/display/command_in_use.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "services/core/display/tracking_display.hpp"

namespace stillhand::display::command_in_use_test {

TEST(CommandInUseTest, TheNewestCommandIsTakenForTenTicks) {
  CommandInUse sut;
  EXPECT_EQ(sut.at(5).tick, -1);
  EXPECT_EQ(sut.at(5).angle_rad, 0.0);
  sut.offer({-1, 0.25});
  EXPECT_EQ(sut.at(5).angle_rad, 0.0);
  sut.offer({100, 0.25});
  EXPECT_EQ(sut.at(100).angle_rad, 0.25);
  EXPECT_EQ(sut.at(101).tick, 100);
  EXPECT_EQ(sut.at(110).angle_rad, 0.25);
  EXPECT_EQ(sut.at(111).angle_rad, 0.0);
  EXPECT_EQ(sut.at(111).tick, -1);
}

TEST(CommandInUseTest, ACommandOfALaterTickOrWithoutAnAngleIsNone) {
  CommandInUse sut;
  sut.offer({100, 0.25});
  EXPECT_EQ(sut.at(99).tick, -1);
  sut.offer({100, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(sut.at(100).tick, -1);
  EXPECT_EQ(sut.at(100).angle_rad, 0.0);
}

TEST(CommandInUseTest, TheCursorFollowsTheRest) {
  TrackingDisplay::Config config;
  TrackingDisplay sut(config);
  EXPECT_DOUBLE_EQ(sut.step({1, 0.3, 0.1}).cursor_m, config.gain_m_rad * 0.2);
  // To the bit as before where nothing is taken off.
  EXPECT_EQ(sut.step({2, 0.3, 0.0}).cursor_m, config.gain_m_rad * 0.3);
}

}  // namespace stillhand::display::command_in_use_test
