// SPDX-License-Identifier: Apache-2.0
// Eq. DR-19: what a check with the hand off refuses.
#include "services/core/device_rig/hand_off.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace stillhand::device_rig::hand_off_test {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(HandOffTest, TravelOfTheSettingsIsRightAndAnotherSignZeroOrRatioIsNot) {
  EXPECT_THAT(travel_fault(0.52, -0.50, 0.5236), IsEmpty());
  EXPECT_THAT(travel_fault(-0.52, 0.52, 0.5236), HasSubstr("change drive.angle_sign"));
  EXPECT_THAT(travel_fault(0.60, -0.44, 0.5236), HasSubstr("another zero"));
  EXPECT_THAT(travel_fault(1.04, -1.04, 0.5236), HasSubstr("another ratio"));
  EXPECT_THAT(travel_fault(0.52, 0.50, 0.5236), HasSubstr("not the stops"));
}

TEST(HandOffTest, AWeightReadsItsOwnForce) {
  EXPECT_THAT(weight_fault(0.9, 1.0), IsEmpty());
  EXPECT_THAT(weight_fault(-1.0, 1.0), HasSubstr("the sign is wrong"));
  EXPECT_THAT(weight_fault(1.4, 1.0), HasSubstr("another calibration"));
  // A tenth of the weight is no sign.
  EXPECT_THAT(weight_fault(-0.15, 2.0), HasSubstr("another calibration"));
  EXPECT_THAT(weight_fault(-0.25, 2.0), HasSubstr("the sign is wrong"));
  EXPECT_THAT(weight_fault(9.8, 1.0), HasSubstr("another weight"));
}

TEST(HandOffTest, APushMovesTheStickItsWayAndIsMeasured) {
  EXPECT_THAT(push_fault({1.0, 0.95, 0.0012}, 0.001), IsEmpty());
  EXPECT_THAT(push_fault({-1.0, -0.95, -0.0012}, 0.001), IsEmpty());
  EXPECT_THAT(push_fault({1.0, 1.0, -0.0012}, 0.001), HasSubstr("change drive.torque_sign"));
  EXPECT_THAT(push_fault({-1.0, -1.0, 0.0012}, 0.001), HasSubstr("change drive.torque_sign"));
  EXPECT_THAT(push_fault({1.0, 1.0, 0.0002}, 0.001), HasSubstr("friction is larger"));
  EXPECT_THAT(push_fault({1.0, 0.1, 0.0012}, 0.001), HasSubstr("stick.lever_m"));
  EXPECT_THAT(push_fault({1.0, 1.0, std::nan("")}, 0.001), HasSubstr("it is held"));
  EXPECT_THAT(push_fault({1.0, std::nan(""), 0.0012}, 0.001), HasSubstr("stick.lever_m"));
}

TEST(HandOffTest, AStrokeHasItsLengthAndItsAcceleration) {
  EXPECT_THAT(stroke_fault({0.001, 0.00095, 0.9, true}), IsEmpty());
  EXPECT_THAT(stroke_fault({0.001, 0.00095, 0.0, false}), IsEmpty());
  EXPECT_THAT(stroke_fault({0.001, -0.001, 0.9, true}), HasSubstr("sign or scale"));
  EXPECT_THAT(stroke_fault({0.001, 0.0013, 0.9, true}), HasSubstr("sign or scale"));
  EXPECT_THAT(stroke_fault({0.001, 0.001, -0.9, true}), HasSubstr("moves against the platform"));
  EXPECT_THAT(stroke_fault({0.001, 0.001, 9.8, true}), HasSubstr("another calibration"));
  // A sensor that does not move at all has no sign.
  EXPECT_THAT(stroke_fault({0.001, 0.001, -0.02, true}), HasSubstr("does not follow"));
}

// 0.05 m/s^2 in a cycle of 0.2 s, about that of a check; the largest delay is looked at, too.
TEST(HandOffTest, TheGainIsThatOfTheReadingWhateverItsZeroAndDelay) {
  for (const auto& [gain, delay] : {std::pair{1.0, 0u}, {1.0, 40u}, {-0.7, 40u}}) {
    std::vector<double> asked(600), read(600);
    for (std::size_t i = 0; i < 200; ++i)
      asked[i] = 0.05 * std::sin(0.0314159265 * static_cast<double>(i));
    for (std::size_t i = delay; i < 600; ++i) read[i] = gain * asked[i - delay];
    for (double& each : read) each += 0.3;
    EXPECT_NEAR(stroke_gain(asked, read, 40), gain, 0.02);
    EXPECT_EQ(stroke_gain(std::vector<double>(600), read, 40), 0.0);
  }
}

}  // namespace stillhand::device_rig::hand_off_test
