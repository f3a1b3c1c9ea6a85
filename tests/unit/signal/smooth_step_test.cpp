// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/smooth_step.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::smooth_step_test {
namespace {

TEST(SmoothStepTest, ItRestsAtBothEnds) {
  for (const double u : {0.0, 1.0}) {
    EXPECT_EQ(smooth_step(u), u);
    EXPECT_EQ(smooth_step_speed(u), 0.0);
    EXPECT_EQ(smooth_step_bend(u), 0.0);
  }
}

// Central differences over 2 h: errors below h^2/6 of the third derivatives (60 and 360), so 4e-5
// and 3e-4.
TEST(SmoothStepTest, SpeedAndBendAreItsDerivatives) {
  constexpr double kH = 2e-3;
  for (double u = 0.05; u < 0.96; u += 0.05) {
    EXPECT_NEAR((smooth_step(u + kH) - smooth_step(u - kH)) / (2.0 * kH), smooth_step_speed(u),
                5e-5);
    EXPECT_NEAR((smooth_step_speed(u + kH) - smooth_step_speed(u - kH)) / (2.0 * kH),
                smooth_step_bend(u), 3e-4);
  }
}

}  // namespace
}  // namespace stillhand::signal::smooth_step_test
