// SPDX-License-Identifier: Apache-2.0
// When a model of the force acts, tick by tick: Eq. CC-2, CC-3, CC-10 and CC-16, before the
// envelope, which would hide a jump.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/core/cancellation/parts/force.hpp"

namespace stillhand::cancellation::force_timing_test {
namespace {

// A gain settles in one tick, a pole of 0.99 in ln 0.01/ln 0.99 = 458.2.
signal::DifferenceModel gain(double n_s2_m) { return {1000.0, {n_s2_m}, {1.0}}; }
constexpr Tick kSettle = 459;
const signal::DifferenceModel kSlow{1000.0, {0.03, 0.0}, {1.0, -0.99}};

PreparedModel prepared(const ControlModel& model) {
  const Preparation out = prepare(model, {60.0, 10.0});
  EXPECT_EQ(out.refusal, Refusal::kNone);
  return out.model;
}
PreparedModel prepared(const signal::DifferenceModel& model) {
  return prepared(control_model(model));
}

ChannelSample at(double accel_m_s2, double theta_rad = 0.0) {
  return {0.0, accel_m_s2, 9.81, 0.0, theta_rad, 0.0};
}

// Weight of a model whose first step is that of tick `from`.
double share(Tick tick, Tick from, Tick settle = 1) {
  return std::clamp(static_cast<double>(tick - from - settle) / 250.0, 0.0, 1.0);
}

TEST(ForceTimingTest, EachModelSettlesAndThenFadesInOneAfterTheOther) {
  Force sut{Config{}};
  sut.take(prepared(gain(2.0)));
  for (Tick n = 0; n < 2000; ++n) {
    if (n == 300) sut.take(prepared(gain(5.0)));
    // Within the fade, up to tick 551: the newest waits for its end.
    if (n == 400) sut.take(prepared(gain(-7.0)));
    if (n == 401) sut.take(prepared(gain(3.0)));
    // It settles still and has no part in the force: the next one takes its place at once.
    if (n == 1000) sut.take(prepared(kSlow));
    if (n == 1200) sut.take(prepared(gain(4.0)));
    const auto out = sut.step(n, at(1.0), kGood, false);
    const double expected =
        2.0 * share(n, 0) + 3.0 * share(n, 300) - 2.0 * share(n, 552) + share(n, 1200);
    ASSERT_NEAR(out.predicted_n, expected, 1e-12) << n;
    ASSERT_NEAR(out.against_n, expected, 1e-12) << n;
  }
}

// The newest model begins, whether another fades in or waits; what was there before has no part.
TEST(ForceTimingTest, AClockThatBeginsAgainStartsTheNewestModelFromRest) {
  for (const int models : {1, 2, 3}) {
    Force sut{Config{}};
    for (Tick n = 0; n < 700; ++n) {
      if (n == 0) sut.take(prepared(gain(2.0)));
      if (n == 500 && models > 1) sut.take(prepared(gain(5.0)));
      if (n == 600 && models > 2) sut.take(prepared(kSlow));
      sut.step(n, at(1.0), kGood, false);
    }
    const auto again = sut.step(100, at(1.0), kGood, false);
    EXPECT_EQ(again.predicted_n, 0.0);
    EXPECT_EQ(again.flags, Flags{kInputInvalid});
    EXPECT_FALSE(again.sound);
    for (Tick n = 101; n < 1500; ++n) {
      const double of_gain = (models == 1 ? 2.0 : 5.0) * share(n, 101);
      const double of_slow = 3.0 * (1.0 - std::pow(0.99, static_cast<double>(n - 100)));
      ASSERT_NEAR(sut.step(n, at(1.0), kGood, false).predicted_n,
                  models < 3 ? of_gain : of_slow * share(n, 101, kSettle), 1e-9)
          << n << " with " << models;
    }
  }
}

TEST(ForceTimingTest, ATickThatComesTwiceCostsItsForceAlone) {
  Force sut{Config{}};
  sut.take(prepared(gain(2.0)));
  for (Tick n = 0; n < 400; ++n) sut.step(n, at(1.0), kGood, false);
  const auto twice = sut.step(399, at(1.0), kGood, false);
  EXPECT_EQ(twice.predicted_n, 0.0);
  EXPECT_FALSE(twice.sound);
  EXPECT_EQ(sut.step(400, at(1.0), kGood, false).predicted_n, 2.0);
}

// 50 ticks are bridged, by samples that are unsound as by samples that are lost; the 51st starts
// the filter from rest, of a platform that stands still.
TEST(ForceTimingTest, TheLastSampleIsHeldForItsTicksAndNoLonger) {
  for (const bool lost : {false, true}) {
    for (const Tick absent : {50, 51, 120}) {
      Force sut{Config{}};
      sut.take(prepared(kSlow));
      // Runs of 49 that a sound sample ends are not one.
      for (Tick n = 0; n <= 3000; ++n) {
        sut.step(n, at(n > 2000 && n % 50 != 0 ? NAN : 2.0), kGood, false);
      }
      constexpr Tick kBegin = 3001;
      Tick n = kBegin;
      for (; n < kBegin + absent; ++n) {
        if (lost) continue;
        const auto out = sut.step(n, at(NAN), kGood, false);
        ASSERT_NEAR(out.predicted_n, n < kBegin + 50 ? 6.0 : 0.0, 1e-9) << n;
        ASSERT_FALSE(out.sound);
      }
      const Tick back = n;
      for (; n < back + 1000; ++n) {
        const auto out = sut.step(n, at(2.0), kGood, false);
        const double from_rest = 6.0 * (1.0 - std::pow(0.99, static_cast<double>(n - back + 1)));
        ASSERT_NEAR(out.predicted_n, absent == 50 ? 6.0 : from_rest * share(n, back - 1, kSettle),
                    1e-9)
            << n << " behind " << absent << (lost ? " lost" : " unsound");
        ASSERT_TRUE(out.sound);
        ASSERT_EQ(out.flags, lost && n == back ? Flags{kInputGap} : kGood);
      }
    }
  }
}

// Eq. CC-16: a sample of the model that is lost is made of the acceleration before it; its force
// acts a sample later.
TEST(ForceTimingTest, ALostSampleOfTheModelIsTakenAtItsTick) {
  Config config;
  config.sampling.model_ticks = 20;
  config.sampling.latency_samples = 1;
  Force sut(config);
  const Preparation slow = prepare(control_model({50.0, {1.0}, {1.0}}), bounds(config));
  sut.take(slow.model);
  const auto is_lost = [](Tick n) { return n == 679 || n == 680 || n == 720; };
  for (Tick n = 0; n < 1000; ++n) {
    if (is_lost(n)) continue;
    const double predicted_n =
        sut.step(n, at(static_cast<double>(n) / 100.0), kGood, false).predicted_n;
    Tick from = n - n % 20 - 20;
    while (is_lost(from)) --from;
    if (n > 600) {
      ASSERT_NEAR(predicted_n, static_cast<double>(from) / 100.0, 1e-12) << n;
    }
  }
  sut.step(1, at(1.0), kGood, false);  // from rest nothing is held
  for (Tick n = 2; n < 80; ++n) {
    const double expected = n < 40 ? 0.0 : share(n, 2, slow.model.filter.settle_ticks());
    ASSERT_NEAR(sut.step(n, at(1.0), kGood, false).predicted_n, expected, 1e-12) << n;
  }
}

TEST(ForceTimingTest, ALowPassOfOrderOneStartsFromRestWithTheFilter) {
  Config config;
  config.sampling.low_pass_order = 1;
  Force sut(config);
  sut.take(prepared(gain(2.0)));
  for (Tick n = 100; n < 1000; ++n) {
    ASSERT_EQ(sut.step(n, at(1.0), kGood, false).flags, kGood) << n << ", 100 being the first";
  }
  EXPECT_NEAR(sut.step(1000, at(1.0), kGood, false).predicted_n, 2.0, 1e-9);
  sut.step(0, at(1.0), kGood, false);
  signal::Butterworth low_pass(1, config.sampling.low_pass_hz, 1000.0);
  for (Tick n = 1; n < 100; ++n) {
    const double expected = 2.0 * low_pass.step(1.0) * share(n, 1);
    ASSERT_NEAR(sut.step(n, at(1.0), kGood, false).predicted_n, expected, 1e-12) << n;
  }
}

// At its bound an acceleration is one, above it a fault; other channels end at their full scale.
TEST(ForceTimingTest, ChannelsEndAtTheirFullScaleAndAYAtItsBound) {
  ControlModel model = control_model(gain(1.0));
  model.paths = {{Channel::kAccelX, 0.0, {}, 0.1}, {Channel::kTheta, 0.0, {}, 10.0}};
  Force sut{Config{}};
  sut.take(prepared(model));
  for (Tick n = 0; n < 300; ++n) sut.step(n, at(0.0), kGood, false);
  Tick n = 300;
  for (const double sign : {-1.0, 1.0}) {
    const auto most = sut.step(n++, {0.0, sign * 16.0, 0.0, 0.0, 0.0, 0.0}, kGood, false);
    EXPECT_DOUBLE_EQ(most.predicted_n, sign * 16.0);
    EXPECT_TRUE(most.sound);
    const auto more = sut.step(n++, {0.0, sign * 16.001, 0.0, 0.0, 0.0, 0.0}, kGood, false);
    EXPECT_EQ(more.flags, Flags{kInputInvalid});
    const ChannelSample others{sign * 20.0, 0.0, 0.0, 0.0, sign * 7.0, 0.0};
    EXPECT_DOUBLE_EQ(sut.step(n++, others, kGood, false).predicted_n, sign * (1.667 + 6.0));
  }
}

// Eq. CC-10 and CC-6: the weights are those of an AdaptiveGain that has seen the same, moved only
// in full effect, and a path from the stick is not scaled.
TEST(ForceTimingTest, GainAndPhaseAreFollowedInFullEffectAndNothingElse) {
  ControlModel model = control_model(gain(2.0));
  model.paths = {{Channel::kTheta, 0.0, {}, 3.0}};
  model.adapts = kAverageHand;
  Force sut{Config{}};
  sut.take(prepared(model));
  AdaptiveGain reference(kAverageHand);
  const auto run = [&](Tick from, Tick to) {
    for (Tick n = from; n < to; ++n) {
      const double a = 3.0 * std::sin(7e-3 * static_cast<double>(n));
      const double theta = 0.1 * std::sin(7e-3 * static_cast<double>(n) - 0.4);
      const bool in_effect = n % 5000 < 4000;
      const auto out = sut.step(n, at(a, theta), kGood, in_effect);
      const double against_n = reference.step(2.0 * a, theta, in_effect && n > from + 251);
      if (n <= from + 251) continue;
      ASSERT_NEAR(out.predicted_n, 2.0 * a + 3.0 * theta, 1e-12) << n;
      ASSERT_NEAR(out.against_n, against_n + 3.0 * theta, 1e-12) << n;
    }
  };
  run(0, 6000);
  EXPECT_GT(std::abs(sut.weights()[0] - 1.0), 0.01);
  sut.step(0, at(0.0), kGood, true);
  reference.reset();  // the motion alone: what was learnt stays
  run(1, 3000);
}

// Countermeasure::use(): a hand that is followed holds for the models of before and after it.
TEST(ForceTimingTest, AHandIsFollowedWithEveryModelUntilItIsTakenBack) {
  for (const int models : {1, 2, 3}) {
    for (const Tick given : {0, 450}) {
      Force sut{Config{}};
      for (Tick n = 0; n < 2000; ++n) {
        if (n == given) sut.follow(AdaptiveGain(kAverageHand));
        if (n == 0) sut.take(prepared(gain(2.0)));
        if (n == 300 && models > 1) sut.take(prepared(gain(5.0)));
        if (n == 400 && models > 2) sut.take(prepared(gain(3.0)));  // waits until tick 552
        sut.step(n, at(std::sin(7e-3 * static_cast<double>(n)), 0.05), kGood, true);
        if (n >= 300 && n < 300 + 252 * (models - 1) - 1) {
          ASSERT_EQ(sut.weights()[0], 1.0) << n << ": nothing is learnt in a fade";
        }
      }
      EXPECT_NE(sut.weights()[0], 1.0) << models << " models, given at " << given;
      sut.follow(std::nullopt);
      EXPECT_EQ(sut.weights(), (AdaptiveGain::Pair{1.0, 0.0}));
    }
  }
}

// No model that was checked comes here.  A force of 1.7e308 N is finite, and f'/Omega is not.
TEST(ForceTimingTest, WhatIsNotFiniteIsAFaultAndStartsFromRest) {
  for (const bool adapts : {false, true}) {
    const double size = adapts ? 1.7e308 : 1e308;
    const AdaptiveGain own = adapts ? AdaptiveGain(kAverageHand) : AdaptiveGain();
    Force sut{Config{}};
    sut.take({ControlModelFilter(control_model(gain(size)), 1), HeldForce(), own, own});
    for (Tick n = 0; n < 400; ++n) {
      EXPECT_EQ(sut.step(n, at(0.0), kGood, false).flags, kGood);
    }
    const auto out = sut.step(400, at(adapts ? 1.0 : 2.0), kGood, false);
    EXPECT_EQ(out.flags, Flags{kFault});
    EXPECT_FALSE(out.sound);
    EXPECT_EQ(out.predicted_n, 0.0);
    EXPECT_EQ(out.against_n, 0.0);
    EXPECT_EQ(sut.unsettled_ticks(), 251);
  }
}

}  // namespace
}  // namespace stillhand::cancellation::force_timing_test
