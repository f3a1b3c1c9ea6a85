// SPDX-License-Identifier: Apache-2.0
#include "services/core/sensing/conditioner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "services/core/contract/units.hpp"

namespace stillhand::sensing::conditioner_test {
namespace {

constexpr double kDt_s = kControlPeriod_s;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A sample that reads these values without noise or rounding.
DeviceSample reading(Tick tick, double a_y_m_s2, double force_n, std::int64_t counts = 0) {
  const Config config;
  DeviceSample sample;
  sample.tick = tick;
  sample.accel_x_v = config.accel_x_offset_v;
  sample.accel_y_v = a_y_m_s2 * config.accel_sensitivity_v_m_s2 + config.accel_y_offset_v;
  sample.accel_z_v = 9.80665 * config.accel_sensitivity_v_m_s2 + config.accel_z_offset_v;
  sample.load_cell_v = force_n * config.load_cell_sensitivity_v_n + config.load_cell_offset_v;
  sample.encoder_counts = counts;
  return sample;
}

// Rounding only: values of order 10, a dozen operations.
constexpr double kRounding = 1e-13;

TEST(ConditionerTest, StartsSettledAtTheFirstSample) {
  Conditioner sut{Config{}};
  for (Tick n = 700; n < 720; ++n) {
    const auto out = sut.step(reading(n, 3.0, -8.0, 100));
    EXPECT_NEAR(out.accel_x_m_s2, 0.0, kRounding);
    EXPECT_NEAR(out.accel_y_m_s2, 3.0, kRounding);
    EXPECT_NEAR(out.accel_z_m_s2, 9.80665, kRounding);
    EXPECT_NEAR(out.force_n, -8.0, kRounding);
    EXPECT_NEAR(out.theta_rad, 100.0 * kTwoPi / 4096.0, kRounding);
    EXPECT_EQ(out.omega_rad_s, 0.0);
    EXPECT_EQ(out.flags, kGood);
  }
}

// The paper's identification divides force by acceleration: with the same filter on both, a force
// that is -3.2 kg times the acceleration stays so, sample for sample, on each axis.
TEST(ConditionerTest, LeavesTheRatioOfForceToAccelerationUnchanged) {
  Conditioner sut{Config{}};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-5.0, 5.0);
  for (Tick n = 0; n < 5000; ++n) {
    const double a_m_s2 = uniform(random);
    DeviceSample sample = reading(n, a_m_s2, -3.2 * a_m_s2);
    sample.accel_x_v = sample.accel_z_v = sample.accel_y_v;
    const auto out = sut.step(sample);
    ASSERT_NEAR(out.force_n, -3.2 * out.accel_y_m_s2, 100.0 * kRounding);
    ASSERT_EQ(out.accel_x_m_s2, out.accel_y_m_s2);
    ASSERT_EQ(out.accel_z_m_s2, out.accel_y_m_s2);
  }
}

double gain_at(double frequency_hz) {
  Conditioner sut{Config{}};
  std::complex<double> out = 0.0;
  for (Tick n = 0; n < 2000; ++n) {
    const double turn_rad = kTwoPi * frequency_hz * static_cast<double>(n) * kDt_s;
    const auto sensed = sut.step(reading(n, std::sin(turn_rad), 0.0));
    if (n >= 1000) out += sensed.accel_y_m_s2 * std::polar(1.0 / 500.0, -turn_rad);
  }
  return std::abs(out);
}

// Second-order Butterworth through the bilinear transform: 1/sqrt(1 + (tan(pi f/fs)/tan(pi
// fc/fs))^4).
TEST(ConditionerTest, FiltersAsASecondOrderButterworthAt200Hertz) {
  for (const double f : {5.0, 50.0, 200.0, 400.0}) {
    const double ratio = std::tan(std::numbers::pi * f / 1000.0) / std::tan(0.2 * std::numbers::pi);
    EXPECT_NEAR(gain_at(f), 1.0 / std::sqrt(1.0 + std::pow(ratio, 4)), 1e-9) << f << " Hz";
  }
}

// A constant rate: counts rise by 2 a tick = 3.068 rad/s; after 0.2 s a 30 Hz filter has settled to
// e^-(4.44 * 30 * 0.2) = 3e-12.
TEST(ConditionerTest, RateIsTheSlopeOfTheAngle) {
  Conditioner sut{Config{}};
  Sensed out{};
  for (Tick n = 0; n < 200; ++n) out = sut.step(reading(n, 0.0, 0.0, 2 * n));
  EXPECT_NEAR(out.omega_rad_s, 2.0 * kTwoPi / 4096.0 * 1000.0, 1e-10);
}

// A straight line is bridged exactly, for 50 ticks at most: the filters can't tell the gap.
TEST(ConditionerTest, BridgesAGapAsIfTheLineHadBeenSampled) {
  Conditioner whole{Config{}};
  Conditioner sut{Config{}};
  const auto on_the_line = [](Tick n) {
    return reading(n, 0.01 * static_cast<double>(n), -0.03 * static_cast<double>(n), n);
  };
  for (Tick n = 0; n < 300; ++n) {
    const auto expected = whole.step(on_the_line(n));
    if (n >= 100 && n < 150) continue;
    const auto out = sut.step(on_the_line(n));
    EXPECT_EQ(out.flags, n == 150 ? kInputGap : kGood);
    ASSERT_NEAR(out.accel_y_m_s2, expected.accel_y_m_s2, 100 * kRounding) << n;
    ASSERT_NEAR(out.force_n, expected.force_n, 100 * kRounding) << n;
    ASSERT_NEAR(out.omega_rad_s, expected.omega_rad_s, 100 * kRounding) << n;
  }
}

TEST(ConditionerTest, StartsAfreshAfterAGapTooLongToBridge) {
  Conditioner sut{Config{}};
  for (Tick n = 0; n < 100; ++n) sut.step(reading(n, 5.0, 1.0, 200));
  const auto out = sut.step(reading(151, -2.0, 4.0, -100));
  EXPECT_EQ(out.flags, kInputGap);
  EXPECT_NEAR(out.accel_y_m_s2, -2.0, kRounding);
  EXPECT_NEAR(out.force_n, 4.0, kRounding);
  EXPECT_EQ(out.omega_rad_s, 0.0);
}

TEST(ConditionerTest, RepeatsItsOutputForALateOrDoubledSample) {
  Conditioner sut{Config{}};
  Sensed before{};
  for (Tick n = 0; n < 100; ++n)
    before = sut.step(reading(n, std::sin(0.1 * static_cast<double>(n)), 1.0));
  for (const Tick late : {Tick{99}, Tick{98}, Tick{49}, Tick{-1}}) {
    const auto out = sut.step(reading(late, 50.0, 50.0));
    EXPECT_EQ(out.flags, kInputInvalid);
    EXPECT_EQ(out.accel_y_m_s2, before.accel_y_m_s2);
    EXPECT_EQ(out.force_n, before.force_n);
  }
  EXPECT_EQ(sut.step(reading(100, 0.0, 1.0)).flags, kGood);
}

TEST(ConditionerTest, FollowsASourceThatRestarted) {
  Conditioner sut{Config{}};
  for (Tick n = 5000; n < 5100; ++n) sut.step(reading(n, 1.0, 1.0));
  const auto out = sut.step(reading(0, -1.0, 2.0));
  EXPECT_EQ(out.flags, kInputGap);
  EXPECT_NEAR(out.accel_y_m_s2, -1.0, kRounding);
  EXPECT_EQ(sut.step(reading(1, -1.0, 2.0)).flags, kGood);
}

TEST(ConditionerTest, HoldsTheLastGoodValueOfAChannelThatIsNotANumber) {
  Conditioner sut{Config{}};
  auto sample = reading(0, 2.0, -6.0);
  sample.roll_rad = 0.1;
  for (; sample.tick < 100; ++sample.tick) sut.step(sample);
  sample.accel_x_v = sample.accel_y_v = sample.accel_z_v = sample.load_cell_v = kNaN;
  sample.roll_rad = std::numeric_limits<double>::infinity();
  const auto out = sut.step(sample);
  EXPECT_EQ(out.flags, kInputInvalid);
  EXPECT_NEAR(out.accel_x_m_s2, 0.0, kRounding);
  EXPECT_NEAR(out.accel_y_m_s2, 2.0, kRounding);
  EXPECT_NEAR(out.accel_z_m_s2, 9.80665, kRounding);
  EXPECT_EQ(out.roll_rad, 0.1);
  EXPECT_NEAR(out.force_n, -6.0, kRounding);
}

TEST(ConditionerTest, RefusesAnEncoderThatTurnsHalfARevolution) {
  Conditioner sut{Config{}};
  sut.step(reading(0, 0.0, 0.0, 10));
  const auto out = sut.step(reading(1, 0.0, 0.0, std::numeric_limits<std::int64_t>::min()));
  EXPECT_EQ(out.flags, kInputInvalid);
  EXPECT_NEAR(out.theta_rad, 10.0 * kTwoPi / 4096.0, kRounding);
}

TEST(ConditionerTest, SaysWhenAChannelIsAtTheEndOfItsRange) {
  Conditioner sut{Config{}};
  EXPECT_EQ(sut.step(reading(0, 16.0, 99.0)).flags, kGood);
  EXPECT_EQ(sut.step(reading(1, 16.6, 0.0)).flags, kSaturated);
  EXPECT_EQ(sut.step(reading(2, 0.0, 99.99)).flags, kSaturated);
  EXPECT_EQ(sut.step(reading(3, 0.0, -1e300)).flags, kSaturated);
  // The highest code of a board of 16 bits is one below its range.
  auto sample = reading(4, 0.0, 0.0);
  sample.load_cell_v = 10.0 - 20.0 / 65536.0;
  EXPECT_EQ(sut.step(sample).flags, kSaturated);
  sample = reading(5, 0.0, 0.0);
  sample.load_cell_v = 10.0 - 2.0 * 20.0 / 65536.0;
  EXPECT_EQ(sut.step(sample).flags, kGood);
}

// A million samples of anything leave every output finite, and good samples then recover it.
TEST(ConditionerTest, SurvivesAnyInput) {
  const std::vector<double> evil = {
      kNaN, std::numeric_limits<double>::infinity(), 1e308, -1e308, 5e-324, 0.0, 3.0, -9.0};
  Conditioner sut{Config{}};
  std::mt19937_64 random(9);
  Tick tick = 0;
  for (int n = 0; n < 1000000; ++n) {
    tick += static_cast<Tick>(random() % 4);
    DeviceSample sample;
    sample.tick = random() % 50 == 0 ? static_cast<Tick>(random()) : tick;
    sample.accel_x_v = evil[random() % 8];
    sample.accel_y_v = evil[random() % 8];
    sample.accel_z_v = evil[random() % 8];
    sample.load_cell_v = evil[random() % 8];
    sample.roll_rad = evil[random() % 8];
    sample.encoder_counts = static_cast<std::int64_t>(random() >> (random() % 64));
    const auto out = sut.step(sample);
    // Largest calibrated values: 10 V + offset over sensitivity; a second-order Butterworth's
    // absolute impulse response sums to less than 1.3, on the step from one end to the other.
    ASSERT_LT(std::abs(out.accel_y_m_s2), 10.01 / 0.1019716 * 3.6) << n;
    ASSERT_LT(std::abs(out.force_n), 100.05 * 3.6) << n;
    ASSERT_LE(std::abs(out.theta_rad), std::numbers::pi * (1.0 + 1e-9)) << n;
    ASSERT_TRUE(std::isfinite(out.omega_rad_s)) << n;
    ASSERT_LE(std::abs(out.roll_rad), std::numbers::pi) << n;
  }
  Sensed out{};
  for (Tick n = 0; n < 400; ++n) out = sut.step(reading(n, 1.0, 2.0));
  EXPECT_NEAR(out.accel_y_m_s2, 1.0, 1e-9);
  EXPECT_NEAR(out.force_n, 2.0, 1e-9);
}

TEST(ConditionerTest, NamesTheFieldThatIsOutOfRange) {
  const Config config{.antialias_cutoff_hz = 600.0};
  EXPECT_THROW(Conditioner{config}, ConfigError);
}

}  // namespace
}  // namespace stillhand::sensing::conditioner_test
