// SPDX-License-Identifier: Apache-2.0
#include "services/core/human_operator/pointer_operator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"
#include "tests/unit/human_operator/tracking_loop.hpp"

namespace stillhand::human_operator::pointer_operator_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PointerInput at(Tick tick, double pointer_m) { return {tick, pointer_m, 0, true, true}; }

/// Force after the pointer has rested at `pointer_m` for 2 s.
double settled(PointerOperator& sut, double pointer_m) {
  double force_n = 0.0;
  for (Tick t = 0; t < 2000; ++t) force_n = sut.step(at(t, pointer_m)).force_n;
  return force_n;
}

// After 2 s exp(-0.9 * 25 * 2) of the step is left: nothing.
TEST(PointerOperatorTest, TheStickComesToThePointer) {
  const PointerOperator::Config config;
  PointerOperator sut(config);
  Stick stick(config.arm);
  for (Tick t = 0; t < 6000; ++t) stick.push(sut.step(at(t, 0.09)).force_n);
  // 6 s of the arm's own decay B/(2M) = 3.4 1/s leave exp(-20).
  EXPECT_NEAR(config.arm.cursor_per_hand * stick.hand_m(), 0.09, 1e-8);
}

TEST(PointerOperatorTest, ARestingPointerIsHeldWithTheArmsStiffness) {
  const PointerOperator::Config config;
  PointerOperator sut(config);
  EXPECT_NEAR(settled(sut, -0.06), -config.arm.effective_stiffness_n_m * 0.06 / 6.0, 1e-9);
}

// A step of 10 mm every 17 ms (0.6 m/s, as fast as a mouse crosses the screen in half a second).
// The filtered speed changes by at most w_n^2 dt times the step, 10 mm/6 * 625 * 1 ms = 1.04 mm/s a
// tick and what the steps before left (within a factor 2); times B, and K times the speed of under
// 0.2 m/s: far from the 1.4 N jump of the bare pointer.
TEST(PointerOperatorTest, SixtyHertzSamplesAreJoinedSmoothly) {
  const PointerOperator::Config config;
  PointerOperator sut(config);
  double last_n = 0.0;
  double largest_n = 0.0;
  for (Tick t = 0; t < 250; ++t) {
    const double force_n = sut.step(at(t, 0.010 * static_cast<double>(t / 17))).force_n;
    largest_n = std::max(largest_n, std::abs(force_n - last_n));
    last_n = force_n;
  }
  EXPECT_GT(last_n, 10.0);
  EXPECT_LT(largest_n, 0.2);
}

TEST(PointerOperatorTest, AStillPointerHoldsItsPlaceAndIsFlagged) {
  PointerOperator sut{PointerOperator::Config{}};
  const double held_n = settled(sut, 0.06);
  for (Tick t = 2000; t < 5000; ++t) {
    const auto out = sut.step({t, 0.06, t - 2000, true, true});
    ASSERT_NEAR(out.force_n, held_n, 1e-9);
    ASSERT_EQ((out.flags & kInputStale) != 0u, t - 2000 > 500) << "age " << t - 2000;
  }
}

TEST(PointerOperatorTest, ALostLinkFadesToZero) {
  const auto with = [](bool linked, bool active, double pointer_m) {
    PointerOperator sut{PointerOperator::Config{}};
    settled(sut, 0.06);
    for (Tick t = 2000; t < 2000 + kFade_ticks - 1; ++t) {
      EXPECT_GT(sut.step({t, pointer_m, 0, linked, active}).force_n, 0.0);
    }
    return sut.step({2000 + kFade_ticks - 1, pointer_m, 0, linked, active});
  };
  EXPECT_EQ(with(false, true, 0.06).force_n, 0.0);
  EXPECT_EQ(with(true, false, 0.06).force_n, 0.0);
  EXPECT_EQ(with(true, true, kNan).force_n, 0.0);
  EXPECT_NE(with(true, true, kNan).flags & kInputInvalid, 0u);
}

TEST(PointerOperatorTest, TheForceIsBoundedWhateverComes) {
  const PointerOperator::Config config;
  PointerOperator sut(config);
  signal::Gaussian draw(9, 0);
  const double extremes[] = {0.0, 1e300, -1e300, kInfinity, -kInfinity, kNan, 0.15, 5.0};
  double last_n = 0.0;
  double largest_n = 0.0;
  for (Tick t = 0; t < 200'000; ++t) {
    const auto pick = [&] { return extremes[static_cast<std::size_t>(draw.uniform() * 8.0)]; };
    const double pointer_m = t % 10'000 < 5000 ? pick() : 1.0;
    const auto out = sut.step({t, pointer_m, t % 7 - 3, draw.uniform() < 0.999, true});
    ASSERT_LE(std::abs(out.force_n), config.arm.max_force_n) << "tick " << t;
    ASSERT_LE(std::abs(out.force_n - last_n), 2.0 + 1e-9) << "tick " << t;
    largest_n = std::max(largest_n, std::abs(out.force_n));
    last_n = out.force_n;
  }
  EXPECT_EQ(largest_n, config.arm.max_force_n);
}

TEST(PointerOperatorTest, SettingsOutOfRangeAreRefused) {
  PointerOperator::Config config;
  config.smoothing_rad_s = 0.0;
  EXPECT_THROW(PointerOperator{config}, ConfigError);
}

}  // namespace stillhand::human_operator::pointer_operator_test
