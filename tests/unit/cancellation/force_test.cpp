// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/signal/random.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::cancellation::force_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

signal::DifferenceModel body() {
  return identification::to_control_rate(support::body_like_model()).model;
}
// A gain and nothing else: settles in one tick, so that timing is plain.
signal::DifferenceModel pure_gain(double gain_n_s2_m) { return {1000.0, {gain_n_s2_m}, {1.0}}; }

CountermeasureInput sample(Tick tick, double accel_m_s2) {
  return {tick, {0.0, accel_m_s2, 9.81, 0.0, 0.0, 0.0}, kGood, true, true, {}};
}
// A canceller that has run at a steady acceleration until all fading is over; next tick is 2000.
Countermeasure steady(const signal::DifferenceModel& model, double accel_m_s2,
                      const Config& config = {}) {
  Countermeasure sut(config, {.force = true});
  EXPECT_EQ(sut.load_model(control_model(model)), Refusal::kNone);
  for (Tick n = 0; n < 2000; ++n) sut.step(sample(n, accel_m_s2));
  return sut;
}

TEST(ForceTest, ForceIsMinusThePredictionAndGainScalesItAlone) {
  for (const double gain : {1.0, 0.5}) {
    Config config;
    config.gain = gain;
    Countermeasure sut = steady(pure_gain(-3.2), 1.5, config);
    const auto out = sut.step(sample(2000, 1.5));
    EXPECT_DOUBLE_EQ(out.predicted_force_n, -4.8);
    EXPECT_DOUBLE_EQ(out.force_n, 4.8 * gain);
    EXPECT_EQ(out.flags, kGood);
  }
}

TEST(ForceTest, PredictsAsTheModelDoes) {
  // Eq. SG-12 in another structure: the same numbers once fading is over, from rest at tick 0.
  const auto a = support::band_noise(8000, 1000.0, 0.7, 2.0, 1.6, 1);
  const auto expected = signal::simulated(body(), a);
  Countermeasure sut({}, {.force = true});
  ASSERT_EQ(sut.load_model(control_model(body())), Refusal::kNone);
  for (std::size_t n = 0; n < a.size(); ++n) {
    const auto out = sut.step(sample(static_cast<Tick>(n), a[n]));
    if (n > 4000) {
      ASSERT_EQ(out.predicted_force_n, expected[n]) << n;
    }
  }
}

TEST(ForceTest, WithoutAModelThereIsNoForce) {
  Countermeasure sut({}, {.force = true});
  for (Tick n = 0; n < 100; ++n) {
    const auto out = sut.step(sample(n, 5.0));
    EXPECT_EQ(out.force_n, 0.0);
    EXPECT_EQ(out.flags, Flags{kNoModel});
  }
}

TEST(ForceTest, RefusesEveryBadModelWithItsReason) {
  Countermeasure sut({}, {.force = true});
  const auto body_at = [](double rate_hz) {
    signal::DifferenceModel model = body();
    model.rate_hz = rate_hz;
    return model;
  };
  EXPECT_EQ(sut.load_model(control_model({})), Refusal::kMalformed);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 2.0}, {1.0}})), Refusal::kMalformed);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0}, {2.0}})), Refusal::kMalformed);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {kNan}, {1.0}})), Refusal::kNotFinite);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 0.0}, {1.0, kInfinity}})),
            Refusal::kNotFinite);
  EXPECT_EQ(sut.load_model(control_model(body_at(50.0))), Refusal::kWrongRate);
  EXPECT_EQ(sut.load_model(control_model(body_at(1000.0000001))), Refusal::kWrongRate);
  EXPECT_EQ(sut.load_model(control_model(body_at(kNan))), Refusal::kWrongRate);
  std::vector<double> long_one(14, 0.0);
  long_one[0] = 1.0;
  EXPECT_EQ(sut.load_model(control_model({1000.0, long_one, long_one})), Refusal::kOrder);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 0.0}, {1.0, -1.0}})), Refusal::kUnstable);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 0.0}, {1.0, -1.01}})), Refusal::kUnstable);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 0.0, 0.0}, {1.0, 0.0, 1.0}})),
            Refusal::kUnstable);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1e-7, 0.0}, {1.0, -0.9999}})),
            Refusal::kSettling);
  EXPECT_EQ(sut.load_model(control_model(pure_gain(61.0))), Refusal::kGain);
  EXPECT_EQ(sut.load_model(control_model(pure_gain(-1e308))), Refusal::kGain);
  EXPECT_FALSE(sut.has_model());
  EXPECT_EQ(sut.load_model(control_model(body())), Refusal::kNone);
  EXPECT_TRUE(sut.has_model());
}

TEST(ForceTest, ANarrowPeakOfGainIsSeen) {
  // Gain 1 at 0 Hz, about 100 within 0.1 Hz of 137.13 Hz.
  const double radius = 0.9995;
  const double angle_rad = 2.0 * 3.14159265358979 * 137.13 / 1000.0;
  const double d1 = -2.0 * radius * std::cos(angle_rad);
  signal::DifferenceModel model{1000.0, {0.0, 0.0, 0.0}, {1.0, d1, radius * radius}};
  model.numerator[0] = 100.0 * 2.0 * (1.0 - radius) * std::sin(angle_rad);
  EXPECT_EQ(check_model(control_model(model), {60.0, 10.0}).refusal, Refusal::kGain);
  EXPECT_EQ(check_model(control_model(model), {150.0, 10.0}).refusal, Refusal::kNone);
}

TEST(ForceTest, ARefusedModelLeavesTheOneInUse) {
  Countermeasure sut = steady(pure_gain(-3.2), 1.0);
  EXPECT_EQ(sut.load_model(control_model({1000.0, {1.0, 0.0}, {1.0, -2.0}})), Refusal::kUnstable);
  EXPECT_DOUBLE_EQ(sut.step(sample(2000, 1.0)).force_n, 3.2);
}

TEST(ForceTest, EveryRefusalIsExplained) {
  for (int i = 0; i <= static_cast<int>(Refusal::kCompliance); ++i) {
    EXPECT_NE(describe(static_cast<Refusal>(i)), "unknown");
  }
}

// Largest change of the force from one tick to the next, at a steady acceleration.
TEST(ForceTest, SwappingModelsIsBumpless) {
  Countermeasure sut = steady(pure_gain(-3.2), 2.0);
  double last = 6.4;
  double largest = 0.0;
  Tick n = 2000;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const double force_n = sut.step(sample(n++, 2.0)).force_n;
      largest = std::max(largest, std::abs(force_n - last));
      last = force_n;
    }
  };
  ASSERT_EQ(sut.load_model(control_model(pure_gain(-5.0))), Refusal::kNone);
  run(100);  // in the middle of the fade two more arrive; the newest is to win
  ASSERT_EQ(sut.load_model(control_model(pure_gain(4.0))), Refusal::kNone);
  ASSERT_EQ(sut.load_model(control_model(pure_gain(-1.0))), Refusal::kNone);
  run(1000);
  EXPECT_DOUBLE_EQ(last, 2.0);
  // 250 ticks from 10 N to 2 N at the most: 8/250 N a tick.
  EXPECT_LE(largest, 8.0 / 250.0 + 1e-12);
}

TEST(ForceTest, APreparedModelIsTakenAsALoadedOne) {
  Countermeasure prepared({}, {.force = true});
  Countermeasure loaded({}, {.force = true});
  const auto same = [&](Tick tick) {
    const auto a = prepared.step(sample(tick, 2.0));
    const auto b = loaded.step(sample(tick, 2.0));
    return a.force_n == b.force_n && a.predicted_force_n == b.predicted_force_n &&
           a.flags == b.flags;
  };
  const Preparation sound = prepare(control_model(body()), bounds(Config{}));
  const Preparation refused = prepare(control_model({}), bounds(Config{}));
  ASSERT_EQ(sound.refusal, Refusal::kNone);
  EXPECT_EQ(refused.refusal, Refusal::kMalformed);
  EXPECT_FALSE(prepared.has_model());
  for (Tick tick = 0; tick < 100; ++tick) ASSERT_TRUE(same(tick)) << tick;  // both without a model
  prepared.take(sound.model);
  ASSERT_EQ(loaded.load_model(control_model(body())), Refusal::kNone);
  EXPECT_TRUE(prepared.has_model());
  for (Tick tick = 100; tick < 3000; ++tick) ASSERT_TRUE(same(tick)) << tick;
  prepared.take(refused.model);  // empty: nothing happens
  for (Tick tick = 3000; tick < 3100; ++tick) ASSERT_TRUE(same(tick)) << tick;
}

TEST(ForceTest, FirstModelFadesInFromZero) {
  // Body at a steady 2 m/s^2: 6.4 N after settling (under 2 s), over 250 ticks, each of prediction
  // and engagement adding its slope; the filter's own transient is still to come while it settles.
  Countermeasure sut({}, {.force = true});
  for (Tick n = 0; n < 500; ++n) sut.step(sample(n, 2.0));
  ASSERT_EQ(sut.load_model(control_model(body())), Refusal::kNone);
  double last = 0.0;
  for (Tick n = 500; n < 4000; ++n) {
    const double force_n = sut.step(sample(n, 2.0)).force_n;
    ASSERT_LE(std::abs(force_n - last), 2.0 * 6.4 / 250.0) << n;
    last = force_n;
  }
  EXPECT_NEAR(last, 6.4, 0.064);
}

TEST(ForceTest, ForceNeedsEnablingAndPermission) {
  Countermeasure sut = steady(pure_gain(-3.2), 2.0);
  auto input = sample(2000, 2.0);
  input.enabled = false;
  auto out = sut.step(input);
  EXPECT_EQ(out.flags, Flags{kRampingDown});
  EXPECT_DOUBLE_EQ(out.predicted_force_n, -6.4);  // goes on predicting
  for (input.tick = 2001; input.tick < 2040; ++input.tick) out = sut.step(input);
  EXPECT_EQ(out.force_n, 0.0);

  sut = steady(pure_gain(-3.2), 2.0);
  input = sample(2000, 2.0);
  input.permitted = false;
  for (input.tick = 2000; input.tick < 2040; ++input.tick) out = sut.step(input);
  EXPECT_EQ(out.force_n, 0.0);
  EXPECT_EQ(out.flags & kInhibited, Flags{kInhibited});
}

TEST(ForceTest, PermissionRegainedFadesInFromZero) {
  Countermeasure sut = steady(pure_gain(-3.2), 2.0);
  auto input = sample(2000, 2.0);
  input.enabled = false;
  for (; input.tick < 2300; ++input.tick) sut.step(input);
  double last = 0.0;
  for (Tick n = 2300; n < 2600; ++n) {
    const double force_n = sut.step(sample(n, 2.0)).force_n;
    ASSERT_LE(force_n - last, 6.4 / 250.0 + 1e-12);
    last = force_n;
  }
  EXPECT_DOUBLE_EQ(last, 6.4);
}

TEST(ForceTest, UnsoundSamplesCountAsAbsent) {
  for (const Flags flags : {Flags{kInputInvalid}, Flags{kInputStale}, Flags{kFault}}) {
    Countermeasure sut = steady(pure_gain(-3.2), 2.0);
    auto input = sample(2000, -50.0);
    input.sensed_flags = flags;
    const auto out = sut.step(input);
    EXPECT_DOUBLE_EQ(out.predicted_force_n, -6.4);  // the last sound acceleration, held
    EXPECT_EQ(out.flags & flags, flags);
    EXPECT_LT(out.force_n, 6.4);
  }
  for (const double bad : {kNan, kInfinity, -kInfinity, 16.1, -1e300}) {
    Countermeasure sut = steady(pure_gain(-3.2), 2.0);
    const auto out = sut.step(sample(2000, bad));
    EXPECT_DOUBLE_EQ(out.predicted_force_n, -6.4) << bad;
    EXPECT_EQ(out.flags, kInputInvalid | kRampingDown) << bad;
    // One bad sample: back to the full force within the few ticks that the envelope lost.
    for (Tick n = 2001; n < 2010; ++n) sut.step(sample(n, 2.0));
    EXPECT_NEAR(sut.step(sample(2010, 2.0)).force_n, 6.4, 1e-12) << bad;
  }
}

TEST(ForceTest, AShortGapIsBridgedByTheHeldSample) {
  // Without the missing ticks the filter would lag behind; with them it is where a filter is that
  // was given the held value.
  const auto a = support::band_noise(6000, 1000.0, 0.7, 2.0, 1.6, 2);
  std::vector<double> held = a;
  for (std::size_t n = 5001; n <= 5050; ++n) held[n] = a[5000];  // max_hold_ticks
  const auto expected = signal::simulated(body(), held);
  Countermeasure sut({}, {.force = true});
  ASSERT_EQ(sut.load_model(control_model(body())), Refusal::kNone);
  for (std::size_t n = 0; n < a.size(); ++n) {
    if (n > 5000 && n <= 5050) continue;
    const auto out = sut.step(sample(static_cast<Tick>(n), a[n]));
    if (n >= 5000) {
      ASSERT_EQ(out.predicted_force_n, expected[n]) << n;
    }
    EXPECT_EQ(out.flags & kInputGap, n == 5051 ? Flags{kInputGap} : kGood) << n;
  }
}

TEST(ForceTest, ALongGapStartsAnew) {
  Countermeasure sut = steady(body(), 2.0);
  auto out = sut.step(sample(2051, 2.0));  // 51 are lost
  EXPECT_EQ(out.flags & kInputGap, Flags{kInputGap});
  // Settles out of sight again, then fades in.
  double last = out.force_n;
  for (Tick n = 2052; n < 2100; ++n) last = sut.step(sample(n, 2.0)).force_n;
  EXPECT_NEAR(last, 0.0, 1e-12);
  for (Tick n = 2100; n < 6000; ++n) last = sut.step(sample(n, 2.0)).force_n;
  EXPECT_NEAR(last, 6.4, 0.064);
}

TEST(ForceTest, ASampleThatIsNotNewMakesNoForce) {
  Countermeasure sut = steady(pure_gain(-3.2), 2.0);
  CountermeasureOutput out{};
  for (int i = 0; i < 40; ++i) out = sut.step(sample(1999, 2.0));  // a writer that is stuck
  EXPECT_EQ(out.force_n, 0.0);
  EXPECT_EQ(out.flags & kInputInvalid, Flags{kInputInvalid});
  // A clock that began again: one sample lost, then a fresh start.
  sut.step(sample(0, 2.0));
  for (Tick n = 1; n < 1000; ++n) out = sut.step(sample(n, 2.0));
  EXPECT_DOUBLE_EQ(out.force_n, 6.4);
}

TEST(ForceTest, ForceIsBoundedWhateverComes) {
  Config config;
  Countermeasure sut(config, {.force = true});
  signal::Gaussian draw(3, 9);
  Tick tick = 0;
  double last = 0.0;
  const double step_n =
      std::max(config.limits.max_slew_n_s / 1000.0, config.limits.max_force_n / 40.0);
  for (int i = 0; i < 1'000'000; ++i) {
    const double u = draw.uniform();
    if (i % 5000 == 100)
      sut.load_model(control_model(u < 0.5 ? body() : pure_gain(59.0 * draw.uniform())));
    if (i % 5000 == 150) sut.load_model(control_model({1000.0, {draw()}, {draw()}}));
    tick += u < 0.9 ? 1 : u < 0.95 ? static_cast<Tick>(80.0 * draw.uniform()) : 0;
    if (u > 0.9999)
      tick = draw.uniform() < 0.5 ? std::numeric_limits<Tick>::max()
                                  : std::numeric_limits<Tick>::min();
    CountermeasureInput input = sample(tick, 20.0 * draw());
    if (draw.uniform() < 0.01) input.sensed[1] = draw.uniform() < 0.5 ? kNan : 1e308;
    if (draw.uniform() < 0.02) input.sensed_flags = static_cast<Flags>(4e9 * draw.uniform());
    input.enabled = draw.uniform() > 0.01;
    input.permitted = draw.uniform() > 0.01;
    const auto out = sut.step(input);
    ASSERT_LE(std::abs(out.force_n), config.limits.max_force_n) << i;
    ASSERT_LE(std::abs(out.force_n - last), step_n + 1e-12) << i;
    ASSERT_TRUE(std::isfinite(out.predicted_force_n)) << i;
    last = out.force_n;
    if (u > 0.9999) tick = 0;
  }
}

TEST(ForceTest, SettingsOutsideTheirRangeAreRefused) {
  Config config;
  config.gain = 1.3;
  EXPECT_THROW(Countermeasure(config, {.force = true}), ConfigError);
  config = {};
  config.limits.max_force_n = 61.0;
  EXPECT_THROW(Countermeasure(config, {.force = true}), ConfigError);
  config = {};
  config.fade_ticks = 0;
  EXPECT_THROW(Countermeasure(config, {.force = true}), ConfigError);
}

}  // namespace
}  // namespace stillhand::cancellation::force_test
