// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/design.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

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

// Over a band acceleration over speed lies between its ends.  Here the peak binds, with the margin
// of 2 % for what the ride's filter does to it.
TEST_P(EveryFamily, HasItsBandAndAMarginOfThePeak) {
  const Ride sut = ride_of({GetParam(), 3.0, 4.0, 1.0, 1.0, 1}, bounds());
  const auto peak = std::ranges::max(sut.accel_m_s2, {}, [](double a) { return std::abs(a); });
  EXPECT_LE(std::abs(peak), 0.98 * 7.35 + 1e-9);
  EXPECT_GT(std::abs(peak), 0.98 * 7.35 / 1.3);  // levels are tried in steps of 1.3
  double accel = 0.0, speed = 0.0;
  for (Tick n = 2'000; n < 22'000; ++n) {
    accel += std::pow(sut.motion.at(n).acceleration_m_s2, 2);
    speed += std::pow(sut.motion.at(n).velocity_m_s, 2);
  }
  EXPECT_NEAR(std::sqrt(accel / speed) / (2.0 * std::numbers::pi), 3.5, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Design, EveryFamily,
                         testing::Values(Family::kNoise, Family::kMultisine, Family::kSweep,
                                         Family::kSteps));

// Parts of 5 s, half a cosine of half a second between them, at 100 Hz.
TEST(DesignTest, LoudAndQuietPartsTakeTurns) {
  const Ride even = ride_of({Family::kNoise, 1.0, 3.0, 1.0, 1.0, 1}, bounds());
  const Ride sut = ride_of({Family::kSteps, 1.0, 3.0, 1.0, 0.2, 1}, bounds());
  for (const auto& [at, share] : std::vector<std::pair<std::size_t, double>>{
           {0, 1.0}, {499, 1.0}, {525, 0.6}, {550, 0.2}, {999, 0.2}, {1025, 0.6}, {1050, 1.0}}) {
    EXPECT_NEAR(sut.accel_m_s2[at], share * even.accel_m_s2[at], 1e-12) << at;
  }
}

// From 0.5 to 4.5 Hz in 2201 steps of 10 ms: 0.5 9^(n/2201).  0.15 m bind to 1.06 Hz, 1 m/s to
// 1.17 Hz, then the peak.
TEST(DesignTest, ASweepIsAsLoudAsTheLimitsAllowAtEachFrequency) {
  Bounds limits = bounds();
  limits.limits.max_velocity_m_s = 1.0;
  const Ride sut = ride_of({Family::kSweep, 0.5, 4.5, 1.0, 1.0, 1}, limits);
  ASSERT_EQ(sut.accel_m_s2.size(), 2201u);
  EXPECT_EQ(sut.accel_m_s2[0], 0.0);
  for (const auto& [n, most_m_s2] : std::vector<std::pair<int, double>>{
           {300, 2.694764}, {770, 6.776150}, {800, 6.982155}, {1500, 7.35}, {2000, 7.35}}) {
    const double w_rad_s = std::numbers::pi * std::pow(9.0, n / 2201.0);
    const double phase_rad = (w_rad_s - std::numbers::pi) * 22.01 / std::log(9.0);
    EXPECT_NEAR(sut.accel_m_s2[static_cast<std::size_t>(n)], 0.98 * most_m_s2 * std::sin(phase_rad),
                1e-5)
        << n;
  }
}

TEST(DesignTest, WhatTheLimitsForbidIsRefused) {
  Bounds narrow = bounds();
  narrow.limits.max_position_m = 0.001;
  narrow.ride.band_high_hz = 0.4;
  EXPECT_THROW(static_cast<void>(ride_of({Family::kSweep, 0.05, 0.3, 1e4, 1.0, 1}, narrow)),
               ConfigError);
}

TEST(DesignTest, ARunHasTheMotionAndTheChannelsOfTheRecording) {
  auto recorded = made::measured(1500, 8, 1);
  recorded.stretches = {{0, 600, 0.0}, {600, 1300, 6.0}, {1300, 1500, 13.0}};
  const Ride ride = ride_of({Family::kNoise, 1.0, 3.0, 1.0, 1.0, 1}, bounds());
  const diagnosis::Measurement sut = run_of(ride.motion, recorded, "u", "y");
  ASSERT_EQ(sut.size(), 2000U);
  EXPECT_DOUBLE_EQ(sut.find("u")->values[700], ride.motion.at(2'000 + 7'000).acceleration_m_s2);
  // From the longest stretch, of 700 samples, over and over.
  EXPECT_EQ(sut.find("z")->values[750], recorded.find("z")->values[650]);
  EXPECT_EQ(sut.find("y")->values, std::vector<double>(2000, 0.0));
  EXPECT_EQ(sut.weight, std::vector<double>(2000, 1.0));
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
