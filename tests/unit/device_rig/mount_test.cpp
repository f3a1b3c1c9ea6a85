// SPDX-License-Identifier: Apache-2.0
// Eq. DR-33.
#include "services/core/device_rig/mount.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::device_rig::mount_test {

using Vector = std::array<double, 3>;

Mount mount(const std::string& text) { return {"devices.accelerometer.mount", text}; }

// A chip whose x points to the left, whose y points forward, and whose z points up.
TEST(MountTest, ARowIsADirectionOfThePlatformInTheSensorsAxes) {
  const Mount sut = mount("0 1 0, -1 0 0, 0 0 1");
  // 2 m/s^2 to the right at rest: -2 along x, and gravity along z.
  EXPECT_EQ(sut.turned({-2.0, 0.0, 9.81}), (Vector{0.0, 2.0, 9.81}));
  EXPECT_EQ(sut.turned({0.0, 3.0, 9.81}), (Vector{3.0, 0.0, 9.81}));
}

// 30 degrees about the forward axis: at rest gravity shows on the sensor's y, and not after.
TEST(MountTest, ATiltedSensorReadsLevel) {
  const double c = std::sqrt(0.75);
  const Mount sut = mount("1 0 0, 0 " + std::to_string(c) + " -0.5, 0 0.5 " + std::to_string(c));
  const Vector level = sut.turned({0.0, 0.5 * 9.81, c * 9.81});
  // Six decimals of c, times 9.81.
  EXPECT_NEAR(level[1], 0.0, 1e-5);
  EXPECT_NEAR(level[2], 9.81, 1e-5);
}

TEST(MountTest, WhatIsNoMountIsRefused) {
  for (const char* wrong :
       {"", "1 0 0", "1 0 0, 0 1 0, 0 0", "1 0 0, 0 1 0, 0 0 1, 0", "2 0 0, 0 1 0, 0 0 1",
        "1 0 0, 1 0 0, 0 0 1", "1 0 0, 0 1 0, 0 nan 1", "x y z"}) {
    EXPECT_THROW(mount(wrong), ConfigError) << wrong;
  }
  EXPECT_NO_THROW(mount("1 0 0 0 -1 0 0 0 1"));
}

TEST(MountTest, AReadingThatIsNoneLeavesNoAxis) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const double each : mount("1 0 0, 0 1 0, 0 0 1").turned({1.0, kNone, 1.0})) {
    EXPECT_TRUE(std::isnan(each));
  }
}

}  // namespace stillhand::device_rig::mount_test
