// SPDX-License-Identifier: Apache-2.0
// Eq. SN-7 on a stick whose gain from acceleration to angle is known.
#include "apps/libraries/session/sensed_share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "apps/libraries/session/jackknife.hpp"

namespace stillhand::session::sensed_share_test {
namespace {

constexpr double kRate_hz = 100.0;

/// Acceleration with most of its power below 3 Hz; angle = gain * (acceleration, one sample late) +
/// noise of the hand.
SensedMotion motion(std::uint32_t seed, double gain, double noise, double seconds) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  SensedMotion out;
  double fast = 0.0;
  double slow = 0.0;
  double hand = 0.0;
  double before = 0.0;
  for (int n = 0; n < static_cast<int>(seconds * kRate_hz); ++n) {
    fast += 0.15 * (normal(random) - fast);
    slow += 0.15 * (fast - slow);
    hand += 0.05 * (normal(random) - hand);
    out.accel_m_s2.push_back(10.0 * slow);
    out.theta_rad.push_back(gain * before + noise * hand);
    before = out.accel_m_s2.back();
  }
  return out;
}

TEST(SensedShareTest, IsTheShareThatIsMissingInTheGain) {
  for (const double share : {0.0, 0.5, 0.9}) {
    const auto sut = sensed_share(motion(1, 0.01, 0.0, 60.0),
                                  motion(2, 0.01 * (1 - share), 0.0, 60.0), kRate_hz);
    ASSERT_TRUE(sut);
    EXPECT_NEAR(sut->share, share, 0.02);
  }
}

// 95 % of 200 pairs, with a binomial spread of 1.5 %; the jackknife's interval is approximate.
TEST(SensedShareTest, ItsIntervalHoldsTheTruthAsOftenAsItSays) {
  int inside = 0;
  double mean = 0.0;
  constexpr int kPairs = 200;
  for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
    const auto sut = sensed_share(motion(10 + 2 * pair, 0.01, 0.05, 60.0),
                                  motion(11 + 2 * pair, 0.003, 0.05, 60.0), kRate_hz);
    ASSERT_TRUE(sut);
    mean += sut->share / kPairs;
    if (sut->low <= 0.7 && 0.7 <= sut->high) ++inside;
  }
  EXPECT_GE(inside, 178);
  EXPECT_LE(inside, 199);
  EXPECT_NEAR(mean, 0.7, 0.02);
}

// Of 0 to 9: 9/10 of the squares about 4.5, which are 82.5; t of 9 degrees of freedom by the table.
TEST(JackknifeTest, IsMillersVarianceAndTheTableOfStudentsT) {
  const auto place = [](std::size_t j) { return static_cast<double>(j); };
  EXPECT_NEAR(jackknife_variance(place), 74.25, 1e-12);
  EXPECT_NEAR(jackknife_reach(4.0), 2.0 * 2.262, 1e-3);
}

TEST(SensedShareTest, AShortTrialAndAStandingPlatformSayNothing) {
  EXPECT_FALSE(sensed_share(motion(1, 1.0, 0.0, 11.0), motion(2, 1.0, 0.0, 60.0), kRate_hz));
  SensedMotion still = motion(1, 1.0, 0.0, 60.0);
  still.accel_m_s2.assign(still.accel_m_s2.size(), 0.0);
  EXPECT_FALSE(sensed_share(still, still, kRate_hz));
}

TEST(SensedShareTest, AnAngleThatIsNoNumberSaysNothing) {
  const SensedMotion good = motion(1, 0.01, 0.0, 60.0);
  SensedMotion bad = good;
  bad.theta_rad[100] = std::nan("");
  EXPECT_FALSE(sensed_share(good, bad, kRate_hz));
  EXPECT_FALSE(sensed_share(bad, good, kRate_hz));
  bad = good;
  bad.theta_rad.pop_back();
  EXPECT_FALSE(sensed_share(good, bad, kRate_hz));
}

TEST(SensedShareTest, TrialsOfTwoLengthsAreComparedOverTheShorterOne) {
  const auto sut =
      sensed_share(motion(1, 0.01, 0.01, 60.0), motion(2, 0.005, 0.01, 45.0), kRate_hz);
  ASSERT_TRUE(sut);
  EXPECT_NEAR(sut->share, 0.5, 0.05);
}

}  // namespace
}  // namespace stillhand::session::sensed_share_test
