// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::next_run::design_test {

// As the lab asks for a planned run of 20 s.
Bounds bounds() {
  Bounds bounds;
  bounds.ride.kind = motion::MotionKind::kRide;
  bounds.ride.band_low_hz = 0.05;
  bounds.ride.band_high_hz = 6.0;
  bounds.ride.rms_m_s2 = 0.0;
  bounds.ride.peak_m_s2 = 7.35;
  bounds.ride.duration_ticks = 20'000;
  bounds.ride.ramp_ticks = 2'000;
  return bounds;
}

double rms_between(const motion::MotionTrajectory& motion, double from_s, double to_s) {
  double square = 0.0;
  const auto first = static_cast<Tick>(1000.0 * from_s);
  const auto end = static_cast<Tick>(1000.0 * to_s);
  for (Tick n = first; n < end; ++n) {
    square += std::pow(motion.at(motion.ramp_ticks() + n).acceleration_m_s2, 2);
  }
  return std::sqrt(square / static_cast<double>(end - first));
}

class EveryFamily : public testing::TestWithParam<Family> {};

TEST_P(EveryFamily, KeepsTheLimitsAndUsesThem) {
  const Bounds limits = bounds();
  const Ride sut = ride_of({GetParam(), 0.7, 4.0, 1.0, 0.2, 1}, limits);
  const motion::MotionReport& report = sut.motion.report();
  const double used = std::max({report.peak_m_s2 / limits.ride.peak_m_s2,
                                report.peak_velocity_m_s / limits.limits.max_velocity_m_s,
                                report.peak_position_m / limits.limits.max_position_m});
  EXPECT_LE(used, 1.0);
  EXPECT_GT(used, 0.6);
}

TEST_P(EveryFamily, PartOfTheLevelIsThatPartOfTheMotion) {
  const Ride whole = ride_of({GetParam(), 1.0, 3.0, 1.0, 0.2, 1}, bounds());
  const Ride half = ride_of({GetParam(), 1.0, 3.0, 0.5, 0.2, 1}, bounds());
  // A quieter ride may keep a little more of its slow part.
  EXPECT_NEAR(half.motion.report().rms_m_s2 / whole.motion.report().rms_m_s2, 0.5, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Design, EveryFamily,
                         testing::Values(Family::kNoise, Family::kMultisine, Family::kSweep,
                                         Family::kSteps));

TEST(DesignTest, LoudAndQuietPartsTakeTurns) {
  const Ride sut = ride_of({Family::kSteps, 1.0, 3.0, 1.0, 0.2, 1}, bounds());
  // Half a second of change at each end is left out; two noises of 4 s differ by a third.
  const double loud = rms_between(sut.motion, 0.5, 4.5);
  const double quiet = rms_between(sut.motion, 5.75, 9.5);
  EXPECT_NEAR(quiet / loud, 0.2, 0.08);
  EXPECT_GT(rms_between(sut.motion, 10.75, 14.5), 2.0 * quiet);
}

TEST(DesignTest, WhatTheLimitsForbidIsRefused) {
  Bounds narrow = bounds();
  narrow.limits.max_position_m = 0.001;
  narrow.ride.band_high_hz = 0.4;
  EXPECT_THROW(static_cast<void>(ride_of({Family::kSweep, 0.05, 0.3, 1e4, 1.0, 1}, narrow)),
               ConfigError);
}

TEST(DesignTest, ARunHasTheMotionAndTheChannelsOfTheRecording) {
  const auto recorded = made::measured(1500, 8, 1);
  const Ride ride = ride_of({Family::kNoise, 1.0, 3.0, 1.0, 1.0, 1}, bounds());
  const diagnosis::Measurement sut = run_of(ride.motion, recorded, "u", "y");
  ASSERT_EQ(sut.size(), 2000U);
  EXPECT_DOUBLE_EQ(sut.find("u")->values[700], ride.motion.at(2'000 + 7'000).acceleration_m_s2);
  EXPECT_EQ(sut.find("z")->values[1600], recorded.find("z")->values[100]);
}

// x and z are one in the recording, and the platform moves neither.
TEST(DesignTest, ATieThatNoMotionSettlesIsOutOfReach) {
  const auto recorded = made::measured(3300, 4, 1);
  const Contest contest = made::tied();
  const Plan sut = best_plan(contest, recorded, bounds(), [](std::size_t count, const auto& each) {
    for (std::size_t i = 0; i < count; ++i) each(i);
  });
  EXPECT_TRUE(sut.out_of_reach(0, 1));
  EXPECT_LT(sut.probability_settled, 0.02);
  const auto twice = longer(sut, {40.0}, contest, recorded, bounds());
  ASSERT_EQ(twice.size(), 1U);
  EXPECT_EQ(twice[0].seconds, 40.0);
  EXPECT_LT(twice[0].probability_settled, 0.02);
}

TEST(DesignTest, APairIsOutOfReachIfNeitherIsToldFromTheOther) {
  Plan sut;
  sut.best_margin = Eigen::MatrixXd{{0.0, -3.0}, {-2.5, 0.0}};
  EXPECT_TRUE(sut.out_of_reach(0, 1));
  sut.best_margin(1, 0) = -1.0;
  EXPECT_FALSE(sut.out_of_reach(0, 1));
}

}  // namespace stillhand::next_run::design_test
