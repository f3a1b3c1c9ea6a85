// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/slow_way.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::slow_way_test {
namespace {

// Eq. SG-21: the bounds of its header, for distances up to the travel and beyond.
TEST(SlowWayTest, ItBeginsWithTheWholeDistanceAtRestAndEndsSlowlyWithNothing) {
  for (const double distance_m : {0.0, 1e-6, -0.03, 0.064, 0.15, -0.3}) {
    SlowWay sut;
    EXPECT_TRUE(sut.over());
    sut.begin(distance_m);
    auto before = sut.step();
    EXPECT_EQ(before.position_m, distance_m);
    EXPECT_EQ(before.velocity_m_s, 0.0);
    EXPECT_EQ(before.acceleration_m_s2, 0.0);
    while (!sut.over()) {
      const auto now = sut.step();
      // 1e-9: rounding of a product.
      ASSERT_LE(std::abs(now.velocity_m_s), SlowWay::kFastest_m_s + 1e-9);
      ASSERT_LE(std::abs(now.acceleration_m_s2),
                0.37);  // 10/sqrt(3) d/T^2 at d = V 8/15 T, T = 1 s
      ASSERT_LE(std::abs(now.acceleration_m_s2 - before.acceleration_m_s2), 4e-3);  // 60 d/T^3 dt
      ASSERT_LE(std::abs(now.position_m), std::abs(distance_m));
      before = now;
    }
    const auto after = sut.step();
    EXPECT_EQ(after.position_m, 0.0);
    EXPECT_EQ(after.velocity_m_s, 0.0);
    EXPECT_EQ(after.acceleration_m_s2, 0.0);
    EXPECT_GE(sut.length_s(), SlowWay::kShortest_s);
  }
  SlowWay sut;
  sut.begin(0.15);
  // 15/8 d/V, to a tick.
  EXPECT_NEAR(sut.length_s(), 1.875 * 0.15 / 0.12, 0.001);
}

}  // namespace
}  // namespace stillhand::signal::slow_way_test
