// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/tracking_display.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"

namespace stillhand::display::tracking_display_test {

constexpr Tick kStart = 4'000;
constexpr Tick kDuration = 20'000;
constexpr Tick kRamp = 2'000;
constexpr std::uint64_t kSeed = 5;

Trial trial() { return {0, TrialPhase::kTracking, kStart, kDuration, kRamp}; }

TrackingDisplay armed() {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  sut.arm(trial(), kSeed);
  return sut;
}

TEST(TrackingDisplayTest, ARadianOfStickIsSixtyCentimetresOfCursor) {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  EXPECT_DOUBLE_EQ(sut.step({0, 1.0}).cursor_m, 0.6);
  EXPECT_DOUBLE_EQ(sut.step({1, -0.25}).cursor_m, -0.15);
}

TEST(TrackingDisplayTest, TheMeasuredPartIsTheReferenceItself) {
  auto sut = armed();
  const auto reference = reference_on_screen(TrackingDisplay::Config{}, kDuration, kSeed);
  for (Tick tick = kStart; tick < kStart + kDuration; ++tick) {
    ASSERT_EQ(sut.step({tick, 0.0}).target_m, reference.at(tick - kStart)) << "tick " << tick;
  }
}

TEST(TrackingDisplayTest, OutsideTheTrialTheTargetStandsInTheCentre) {
  auto sut = armed();
  for (Tick tick = 0; tick < kStart - kRamp; ++tick) {
    ASSERT_EQ(sut.step({tick, 0.0}).target_m, 0.0);
  }
  for (Tick tick = kStart + kDuration + kRamp; tick < kStart + kDuration + 2 * kRamp; ++tick) {
    ASSERT_EQ(sut.step({tick, 0.0}).target_m, 0.0);
  }
  for (const auto& [number, start] : {std::pair{1, kStart}, {0, kStart + 500}}) {
    sut.postpone({.number = number, .start_tick = kStart + 500});
    EXPECT_EQ(sut.trial().start_tick, start) << "another trial is not postponed";
  }
  sut.disarm();
  EXPECT_EQ(sut.step({kStart + 600, 0.0}).target_m, 0.0);
}

// Largest speed of the reference: w A summed over the lines; the ramp adds at most its own slope,
// 1.875 / ramp, times the largest position.  A jump would show as a speed 1000 times its height.
TEST(TrackingDisplayTest, TheTargetNeverJumps) {
  auto sut = armed();
  const TrackingDisplay::Config config;
  const auto design = signal::reference_design(20.0);
  double speed_m_s = 0.0;
  double height_m = 0.0;
  for (std::size_t k = 0; k < signal::kReferenceLines; ++k) {
    const double a_m = config.reference_scale_m * design.amplitudes[k];
    height_m += a_m;
    speed_m_s += a_m * 2.0 * M_PI * static_cast<double>(design.harmonics[k]) / 20.0;
  }
  const double limit_m = (speed_m_s + height_m * 1.875 / 2.0) * kControlPeriod_s;
  double last_m = 0.0;
  for (Tick tick = 0; tick < kStart + kDuration + 2 * kRamp; ++tick) {
    const double target_m = sut.step({tick, 0.0}).target_m;
    ASSERT_LE(std::abs(target_m - last_m), limit_m) << "tick " << tick;
    last_m = target_m;
  }
}

TEST(TrackingDisplayTest, TheRampsRiseAndFallMonotonously) {
  auto sut = armed();
  const auto reference = reference_on_screen(TrackingDisplay::Config{}, kDuration, kSeed);
  const auto share = [&](Tick tick) {
    return sut.step({tick, 0.0}).target_m / reference.at(tick - kStart);
  };
  // Half way the smooth step is 1/2; its slope there is 1.875 / ramp, half a tick off at most.
  EXPECT_NEAR(share(kStart - kRamp / 2), 0.5, 1.875 / kRamp);
  EXPECT_NEAR(share(kStart + kDuration + kRamp / 2), 0.5, 1.875 / kRamp);
  double last = 0.0;
  for (Tick tick = kStart - kRamp; tick < kStart; ++tick) {
    ASSERT_GE(share(tick), last - 1e-12);
    last = share(tick);
  }
  EXPECT_NEAR(last, 1.0, 1e-6);
  for (Tick tick = kStart + kDuration; tick < kStart + kDuration + kRamp; ++tick) {
    ASSERT_LE(share(tick), last + 1e-12);
    last = share(tick);
  }
  EXPECT_NEAR(last, 0.0, 1e-6);
  // Next to the measured part, and so all over, they mirror each other.
  for (const Tick n : {0, 700}) {
    EXPECT_NEAR(share(kStart - 1 - n), share(kStart + kDuration + n), 1e-12);
  }
}

TEST(TrackingDisplayTest, InsideMeansTheCrossesCentreIsBetweenTheBoxesSides) {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  Tick tick = 0;
  const auto inside = [&](double cursor_m) { return sut.step({tick++, cursor_m / 0.6}).inside; };
  EXPECT_TRUE(inside(0.0));
  EXPECT_TRUE(inside(0.015 - 1e-9));
  EXPECT_TRUE(inside(-0.015 + 1e-9));
  EXPECT_FALSE(inside(0.015 + 1e-9));
  EXPECT_FALSE(inside(-0.015 - 1e-9));
  // On the very edge is outside.  0.75 * 0.02 and 0.03 / 2 are the same double.
  TrackingDisplay::Config exact;
  exact.gain_m_rad = 0.75;
  TrackingDisplay edge(exact);
  ASSERT_EQ(edge.step({0, 0.02}).cursor_m, 0.015);
  EXPECT_FALSE(edge.step({0, 0.02}).inside);
}

TEST(TrackingDisplayTest, AnAngleThatIsNotFiniteHoldsTheCursorOutside) {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  sut.step({0, 0.01});
  for (const double theta_rad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto sample = sut.step({1, theta_rad});
    EXPECT_DOUBLE_EQ(sample.cursor_m, 0.006);
    EXPECT_FALSE(sample.inside);
    EXPECT_EQ(sample.flags, kInputInvalid);
  }
}

TEST(TrackingDisplayTest, ALostTickIsFlagged) {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  EXPECT_EQ(sut.step({7, 0.0}).flags, kGood);
  EXPECT_EQ(sut.step({8, 0.0}).flags, kGood);
  EXPECT_EQ(sut.step({10, 0.0}).flags, kInputGap);
  EXPECT_EQ(sut.step({11, 0.0}).flags, kGood);
}

TEST(TrackingDisplayTest, APeggedTrialHasNoTarget) {
  TrackingDisplay sut{TrackingDisplay::Config{}};
  Trial pegged = trial();
  pegged.phase = TrialPhase::kPegged;
  sut.arm(trial(), kSeed);
  sut.arm(pegged, kSeed);
  EXPECT_EQ(sut.step({kStart + 1000, 0.0}).target_m, 0.0);
}

TEST(TrackingDisplayTest, ARearmedDisplayHandsTheOldTargetBack) {
  const TrackingDisplay::Config config;
  auto sut = armed();
  const double old_m = reference_on_screen(config, kDuration, kSeed).at(1234);
  auto fresh = reference_on_screen(config, kDuration, kSeed + 1);
  const double fresh_m = fresh.at(1234);
  ASSERT_NE(old_m, fresh_m);
  sut.arm(std::move(fresh), trial());
  EXPECT_EQ(sut.step({kStart + 1234, 0.0}).target_m, fresh_m);
  EXPECT_EQ(fresh.at(1234), old_m);  // NOLINT(bugprone-use-after-move): exchanged, not emptied
}

// 30 seeds at which most first draws leave the screen: the box stays on it, and uses most of it.
TEST(TrackingDisplayTest, TheBoxStaysOnTheScreenAndUsesMuchOfIt) {
  const TrackingDisplay::Config config;
  const double limit_m = 0.3048 / 2.0 - 0.015 - 0.0005;
  int redrawn = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const auto reference = reference_on_screen(config, 60'000, seed);
    const signal::ReferenceSignal first_draw(signal::reference_design(60.0), 60'000, seed,
                                             config.reference_scale_m);
    double peak_m = 0.0;
    for (Tick n = 0; n < 60'000; ++n) peak_m = std::max(peak_m, std::abs(reference.at(n)));
    EXPECT_LE(peak_m, limit_m);
    EXPECT_GT(peak_m, 0.6 * limit_m);
    redrawn += first_draw.at(0) != reference.at(0) ? 1 : 0;
  }
  EXPECT_GT(redrawn, 0);
  EXPECT_LT(redrawn, 30);
}

TEST(TrackingDisplayTest, WhatCannotBeShownIsRefused) {
  TrackingDisplay::Config config;
  config.reference_scale_m = 0.2;
  EXPECT_THROW(reference_on_screen(config, kDuration, 1), ConfigError);
  config = {};
  config.gain_m_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(TrackingDisplay{config}, ConfigError);
  config = {};
  config.screen.track_above_bottom_m = 0.22;  // the box would leave the upper edge
  EXPECT_THROW(TrackingDisplay{config}, ConfigError);
  TrackingDisplay sut{TrackingDisplay::Config{}};
  Trial bad = trial();
  bad.ramp_ticks = -1;
  EXPECT_THROW(sut.arm(bad, 1), ConfigError);
  bad = trial();
  bad.duration_ticks = 4'999;  // under 5 s
  EXPECT_THROW(sut.arm(bad, 1), ConfigError);
  bad = trial();
  bad.start_tick = std::numeric_limits<Tick>::max();
  EXPECT_THROW(sut.arm(bad, 1), ConfigError);
}

}  // namespace stillhand::display::tracking_display_test
