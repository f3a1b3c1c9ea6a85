// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillhand::rig::sensors_test {
namespace {

constexpr SensorInput kRest{0.0, 0.0, kGravity_m_s2, 0.0, 0.0, 0.0};

SensorConfig noiseless() { return {.accel_noise_m_s2_rthz = 0.0, .load_cell_noise_n_rthz = 0.0}; }

// 200,000 samples: the standard deviation of a normal sample is known to 1/sqrt(2N) = 0.16 %, the
// mean to sigma/sqrt(N); both tested at five of those.  The board's rounding adds q^2/12.
TEST(SensorsTest, NoiseHasTheDensityOfTheDataSheet) {
  const SensorConfig config;
  Sensors sut(config, 3);
  constexpr int kCount = 200000;
  double sum_v = 0.0;
  double square_v2 = 0.0;
  double force_square_v2 = 0.0;
  for (int n = 0; n < kCount; ++n) {
    const auto raw = sut.step(kRest).raw;
    const double deviation_v = raw.accel_y_v - config.accel_offset_v;
    sum_v += deviation_v;
    square_v2 += deviation_v * deviation_v;
    force_square_v2 += std::pow(raw.load_cell_v - config.load_cell_offset_v, 2);
  }
  const double code_v = 20.0 / 65536.0;
  const auto expected_v = [&](double density, double sensitivity) {
    return std::hypot(density * std::sqrt(500.0) * sensitivity, code_v / std::sqrt(12.0));
  };
  const double accel_v = expected_v(config.accel_noise_m_s2_rthz, config.accel_sensitivity_v_m_s2);
  const double force_v =
      expected_v(config.load_cell_noise_n_rthz, config.load_cell_sensitivity_v_n);
  EXPECT_NEAR(sum_v / kCount, 0.0, 5.0 * accel_v / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(square_v2 / kCount), accel_v, 5.0 * 0.0016 * accel_v);
  EXPECT_NEAR(std::sqrt(force_square_v2 / kCount), force_v, 5.0 * 0.0016 * force_v);
}

TEST(SensorsTest, EveryVoltageIsACodeWithinHalfACodeOfTheTruth) {
  const auto config = noiseless();
  Sensors sut(config, 1);
  const double code_v = 20.0 / 65536.0;
  for (int n = -500; n <= 500; ++n) {
    const double a_m_s2 = 0.0321 * n;
    const double force_n = 0.0817 * n;
    const auto raw = sut.step({0.0, a_m_s2, kGravity_m_s2, force_n, 0.0, 0.0}).raw;
    ASSERT_EQ(raw.accel_y_v / code_v, std::round(raw.accel_y_v / code_v));
    ASSERT_NEAR(raw.accel_y_v, a_m_s2 * config.accel_sensitivity_v_m_s2 + config.accel_offset_v,
                0.5 * code_v * (1.0 + 1e-9));
    ASSERT_NEAR(raw.load_cell_v,
                force_n * config.load_cell_sensitivity_v_n + config.load_cell_offset_v,
                0.5 * code_v * (1.0 + 1e-9));
  }
}

TEST(SensorsTest, EncoderCountsAreTheNearestToTheAngle) {
  Sensors sut(noiseless(), 1);
  for (int n = -300; n <= 300; ++n) {
    const double theta_rad = 0.00177 * n;
    const auto raw = sut.step({0.0, 0.0, kGravity_m_s2, 0.0, theta_rad, 0.0}).raw;
    const double back_rad =
        static_cast<double>(raw.encoder_counts) * 2.0 * std::numbers::pi / 4096.0;
    ASSERT_NEAR(back_rad, theta_rad, std::numbers::pi / 4096.0 * (1.0 + 1e-9));
  }
}

TEST(SensorsTest, TheVerticalChannelReadsGravityAtRest) {
  const auto config = noiseless();
  Sensors sut(config, 1);
  EXPECT_NEAR(sut.step(kRest).raw.accel_z_v, 1.01, 1.6e-4);  // 1 V/g + 10 mV, half a code
}

TEST(SensorsTest, ClipsAtTheEndOfTheRangeAndSaysSo) {
  const auto config = noiseless();
  Sensors sut(config, 1);
  EXPECT_EQ(sut.step(kRest).flags, kGood);
  const auto shaken = sut.step({0.0, 500.0, kGravity_m_s2, 0.0, 0.0, 0.0});
  EXPECT_EQ(shaken.flags, kSaturated);
  EXPECT_NEAR(shaken.raw.accel_y_v, 16.67 * config.accel_sensitivity_v_m_s2 + 0.01, 1.6e-4);
  const auto pushed = sut.step({0.0, 0.0, kGravity_m_s2, 1e6, 0.0, 0.0});
  EXPECT_EQ(pushed.flags, kSaturated);
  EXPECT_EQ(pushed.raw.load_cell_v, 10.0 - 20.0 / 65536.0);
  const auto pulled = sut.step({0.0, 0.0, kGravity_m_s2, -1e6, 0.0, 0.0});
  EXPECT_EQ(pulled.flags, kSaturated);
  EXPECT_EQ(pulled.raw.load_cell_v, -10.0);
}

TEST(SensorsTest, TheSameSeedGivesTheSameSamplesAndAnotherSeedOthers) {
  Sensors one(SensorConfig{}, 5);
  Sensors same(SensorConfig{}, 5);
  Sensors other(SensorConfig{}, 6);
  int differing = 0;
  for (int n = 0; n < 1000; ++n) {
    const auto raw = one.step(kRest).raw;
    ASSERT_EQ(raw.accel_y_v, same.step(kRest).raw.accel_y_v);
    differing += raw.accel_y_v != other.step(kRest).raw.accel_y_v ? 1 : 0;
  }
  EXPECT_GT(differing, 500);
}

}  // namespace
}  // namespace stillhand::rig::sensors_test
