// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/tick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stillhand::tick_test {
namespace {

TEST(TicksInTest, ADurationIsRoundedToTheNearestTick) {
  EXPECT_EQ(ticks_in(0.0), 0);
  EXPECT_EQ(ticks_in(0.00049), 0);
  EXPECT_EQ(ticks_in(0.00051), 1);
  EXPECT_EQ(ticks_in(0.0014), 1);
  EXPECT_EQ(ticks_in(0.0016), 2);
  EXPECT_EQ(ticks_in(180.0), 180'000);
}

// n/1000 is off by half a unit in its last place at most, which is far below half a tick up to
// 2^50 ticks: the way to seconds and back is exact.
TEST(TicksInTest, WholeTicksSurviveTheWayThroughSeconds) {
  std::mt19937_64 engine(11);
  std::uniform_int_distribution<Tick> any(-(Tick{1} << 50), Tick{1} << 50);
  for (int i = 0; i < 10'000; ++i) {
    const Tick n = any(engine);
    ASSERT_EQ(ticks_in(static_cast<double>(n) / kControlRateHz), n);
  }
}

TEST(TicksInTest, TheResultIsWithinHalfATickAndOddInTheDuration) {
  std::mt19937_64 engine(12);
  std::uniform_real_distribution<double> any_s(0.0, 4000.0);
  for (int i = 0; i < 10'000; ++i) {
    const double duration_s = any_s(engine);
    const Tick n = ticks_in(duration_s);
    ASSERT_EQ(ticks_in(-duration_s), -n) << duration_s << " s";
    // 4e6 ticks carry a rounding error of 4e6 * 2^-53 * 3 operations < 2e-9.
    ASSERT_LE(std::abs(static_cast<double>(n) - duration_s * kControlRateHz), 0.5 + 2e-9);
  }
}

}  // namespace
}  // namespace stillhand::tick_test
