// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/explained_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::cancellation::explained_motion_test {

// Eq. CC-10: r = F P (f, f'/Omega), e = F lever theta; P a mass on damper and spring of natural
// frequency sqrt(K/M) and ratio B/(2 sqrt(K M)), F a band-pass of 0.5 to 3 Hz.
TEST(ExplainedMotionTest, IsTheBandOfTheHandsAnswerAndOfItsMotion) {
  constexpr HandCompliance kHand{2.0, 12.0, 800.0, 0.2};  // 20 rad/s, 0.15
  ExplainedMotion sut(kHand);
  for (int run = 0; run < 2; ++run, sut.reset()) {
    signal::SecondOrderLag hand(20.0, 0.15, 1e-3);
    signal::BandPass band_r(2, 0.5, 3.0, 1000.0);
    signal::BandPass band_e(2, 0.5, 3.0, 1000.0);
    Quadrature quadrature;
    for (int n = 0; n < 2000; ++n) {
      const double force_n = 5.0 * std::sin(7e-3 * n) + 1.0;
      const double theta_rad = 0.1 * std::cos(5e-3 * n);
      const auto out = sut.step(force_n, theta_rad);
      const double r = band_r.step(hand.step(force_n / 800.0).x);
      ASSERT_NEAR(out.r[0], r, 1e-12) << n;
      ASSERT_NEAR(out.r[1], quadrature.step(r), 1e-12) << n;
      ASSERT_NEAR(out.e, band_e.step(0.2 * theta_rad), 1e-12) << n;
    }
  }
}

}  // namespace stillhand::cancellation::explained_motion_test
