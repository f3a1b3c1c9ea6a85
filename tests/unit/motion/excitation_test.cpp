// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/excitation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/motion/peak_limit.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::motion::excitation_test {

MotionProfile profile_of(MotionKind kind) {
  MotionProfile profile;
  profile.kind = kind;
  return profile;
}

double last_of(const MotionSpectrum& s) {
  return static_cast<double>(s.first) + static_cast<double>(s.accel_m_s2.size()) - 1.0;
}

TEST(BandNoiseTest, AllHarmonicsOfTheBandAndNoOthersAreExcitedEqually) {
  const auto sut = band_noise(profile_of(MotionKind::kBandNoise));
  EXPECT_EQ(sut.first, 126);     // 0.7 Hz * 180 s
  EXPECT_EQ(last_of(sut), 360);  // 2 Hz * 180 s
  // Eq. MO-11.
  const double amplitude = 1.6 * std::sqrt(2.0 / 235.0);
  for (const auto& c : sut.accel_m_s2) ASSERT_NEAR(std::abs(c), amplitude, 1e-14);
}

// Eq. MO-11 with n = 4 on 0.7 to 4 Hz: at twice the upper edge (1 + 2^8)^-1/2 of the middle, where
// the lower edge leaves (1 + (0.7/2)^8)^-1/2 and the upper (1 + (2/4)^8)^-1/2.
TEST(BandNoiseTest, ItsEdgesRollOffAsAButterworthFilterToFortyDecibels) {
  auto profile = profile_of(MotionKind::kBandNoise);
  profile.band_high_hz = 4.0;
  profile.band_order = 4;
  const auto sut = band_noise(profile);
  const auto amplitude = [&](double hz) {
    const auto line = static_cast<std::int64_t>(std::llround(hz * sut.period_s));
    return std::abs(sut.accel_m_s2[static_cast<std::size_t>(line - sut.first)]);
  };
  const double middle = 1.0 / std::sqrt((1.0 + std::pow(0.35, 8)) * (1.0 + std::pow(0.5, 8)));
  const double twice = 1.0 / std::sqrt((1.0 + std::pow(0.7 / 8.0, 8)) * (1.0 + 256.0));
  EXPECT_NEAR(amplitude(8.0) / amplitude(2.0), twice / middle, 1e-9);
  EXPECT_NEAR(static_cast<double>(last_of(sut)) / sut.period_s, 4.0 * std::sqrt(10.0), 0.01);
  EXPECT_EQ(sut.first, 40);  // from 0.7 Hz / sqrt(10) on, 39.8
  EXPECT_NEAR(sut.rms_m_s2(), profile.rms_m_s2, 1e-12);
}

// Whatever a message asks for, the grid stays that of the widest band.
TEST(BandNoiseTest, ItsSkirtsEndWhereABandMustEnd) {
  auto profile = profile_of(MotionKind::kBandNoise);
  profile.band_high_hz = 30.0;
  profile.band_order = 1;
  const auto sut = band_noise(profile);
  EXPECT_EQ(last_of(sut), static_cast<std::int64_t>(kHighestBand_hz * 180.0));
  EXPECT_GE(static_cast<double>(sut.first), kLowestBand_hz * 180.0);
}

TEST(BandNoiseTest, TheSeedDecidesEveryBit) {
  auto profile = profile_of(MotionKind::kBandNoise);
  const auto one = band_noise(profile);
  EXPECT_EQ(one.accel_m_s2, band_noise(profile).accel_m_s2);
  profile.seed = 2;
  EXPECT_NE(one.accel_m_s2, band_noise(profile).accel_m_s2);
}

TEST(BandNoiseTest, ABandWithoutAHarmonicAndNoAmplitudeAreRefused) {
  auto profile = profile_of(MotionKind::kBandNoise);
  profile.duration_ticks = 1000;  // harmonics are whole hertz
  profile.band_low_hz = 1.1;
  profile.band_high_hz = 1.9;
  EXPECT_THROW(band_noise(profile), ConfigError);
  profile.band_high_hz = 2.0;
  EXPECT_EQ(band_noise(profile).accel_m_s2.size(), 1u);
  profile.rms_m_s2 = 0.0;
  EXPECT_THROW(band_noise(profile), ConfigError);
}

TEST(MultisineMotionTest, GivenComponentsAreKeptAsTheyAre) {
  auto profile = profile_of(MotionKind::kMultisine);
  profile.rms_m_s2 = 0.0;
  profile.components = {{130, 0.5, 0.1}, {127, 0.25, -2.0}};
  const auto sut = multisine(profile);
  ASSERT_EQ(sut.first, 127);
  ASSERT_EQ(sut.accel_m_s2.size(), 4u);
  // A sin(th) is Re(A exp(j (th - pi/2))).
  EXPECT_NEAR(std::abs(sut.accel_m_s2[0] - std::polar(0.25, -2.0 - std::numbers::pi / 2)), 0.0,
              1e-15);
  EXPECT_EQ(std::abs(sut.accel_m_s2[1]), 0.0);
  EXPECT_NEAR(std::abs(sut.accel_m_s2[3] - std::polar(0.5, 0.1 - std::numbers::pi / 2)), 0.0,
              1e-15);
}

TEST(MultisineMotionTest, WithoutComponentsFifteenTonesFillTheBand) {
  const auto sut = multisine(profile_of(MotionKind::kMultisine));
  int tones = 0;
  for (const auto& c : sut.accel_m_s2) tones += std::abs(c) > 0.0 ? 1 : 0;
  EXPECT_EQ(tones, kDefaultTones);
  EXPECT_EQ(sut.first, 126);
  EXPECT_GT(std::abs(sut.accel_m_s2[213 - 126]), 0.0);  // the geometric mean, 212.98
  EXPECT_EQ(last_of(sut), 360);
  EXPECT_NEAR(sut.rms_m_s2(), 1.6, 1e-14);
}

TEST(MultisineMotionTest, AComponentBeyondNyquistIsNamed) {
  auto profile = profile_of(MotionKind::kMultisine);
  profile.components = {{90'000, 1.0, 0.0}};
  EXPECT_THAT(support::refusal([&] { multisine(profile); }),
              testing::HasSubstr("components[0].harmonic: got 90000"));
}

// Displacement PSD of the lines, |X_k|^2 T / 2, against ISO 8608: class C, G0 = 256e-6 m^3; at
// n = f/u the road has G0 (n/0.1)^-2 per cycle/m, 1/u of it per hertz.  Exact by construction of
// another expression, so to rounding.
TEST(RoadTest, ThePsdIsThatOfItsClassAtEveryLine) {
  auto profile = profile_of(MotionKind::kRoad);
  profile.rms_m_s2 = 0.0;
  profile.road_class = "C";
  profile.road_speed_m_s = 15.0;
  const auto sut = road(profile);
  for (std::size_t i = 0; i < sut.accel_m_s2.size(); ++i) {
    const double w = sut.rad_s(i);
    const double f_hz = w / (2.0 * std::numbers::pi);
    const double psd = std::norm(sut.accel_m_s2[i]) / std::pow(w, 4) * sut.period_s / 2.0;
    const double n_1_m = f_hz / 15.0;
    ASSERT_NEAR(psd / (256e-6 * std::pow(n_1_m / 0.1, -2.0) / 15.0), 1.0, 1e-12);
  }
}

TEST(RoadTest, AnUnknownClassAndABandOutsideTheStandardAreRefused) {
  auto profile = profile_of(MotionKind::kRoad);
  for (const char* wrong : {"I", "a", "", "AB"}) {
    profile.road_class = wrong;
    EXPECT_THROW(road(profile), ConfigError) << wrong;
  }
  for (const char* right : {"A", "H"}) {
    profile.road_class = right;
    EXPECT_NO_THROW(road(profile)) << right;
  }
  for (const double wrong_m_s : {64.0, 0.7}) {  // 0.011 and 2.83 cycles/m are 0.704 and 1.98 Hz
    profile.road_speed_m_s = wrong_m_s;
    EXPECT_THROW(road(profile), ConfigError) << wrong_m_s;
  }
  for (const double right_m_s : {63.0, 0.71}) {  // 0.693 and 2.01 Hz
    profile.road_speed_m_s = right_m_s;
    EXPECT_NO_THROW(road(profile)) << right_m_s;
  }
}

TEST(PeakLimitTest, PhasesChangeMagnitudesDoNotAndTheBoundHolds) {
  auto profile = profile_of(MotionKind::kBandNoise);
  profile.band_high_hz = 4.0;
  profile.rms_m_s2 = 2.2;
  profile.duration_ticks = 120'000;
  for (profile.seed = 1; profile.seed <= 4; ++profile.seed) {
    const auto before = band_noise(profile);
    auto sut = before;
    EXPECT_GT(limit_peaks(sut, {6.5, 0.13}), 0);
    for (std::size_t i = 0; i < sut.accel_m_s2.size(); ++i) {
      // 200 rescalings of one rounding each.
      ASSERT_NEAR(std::abs(sut.accel_m_s2[i]) / std::abs(before.accel_m_s2[i]), 1.0, 1e-13);
    }
    const HarmonicMotion motion(sut);
    for (Tick n = 0; n < profile.duration_ticks; ++n) {
      const auto sample = motion.at(n);
      ASSERT_LE(std::abs(sample.accel_m_s2), 6.5);
      ASSERT_LE(std::abs(sample.pos_m), 0.13);
    }
  }
}

TEST(PeakLimitTest, PhasesThatAreGoodEnoughStay) {
  const auto before = band_noise(profile_of(MotionKind::kBandNoise));
  auto sut = before;
  EXPECT_EQ(limit_peaks(sut, {20.0, 1.0}), 0);
  EXPECT_EQ(sut.accel_m_s2, before.accel_m_s2);
}

// A tone's peak is its amplitude, wherever it lies between the points of the grid.  The grid is
// held to cos(pi/25) of the bound, Eq. MO-10: 0.8 %.
TEST(PeakLimitTest, APeakBetweenTwoPointsCounts) {
  for (int part = 0; part < 50; ++part) {
    MotionSpectrum sut = band_noise(profile_of(MotionKind::kBandNoise));
    sut.accel_m_s2 = {std::polar(1.0, 0.02 * part)};
    EXPECT_THROW(limit_peaks(sut, {0.999, 10.0}), ConfigError) << part;
    EXPECT_EQ(limit_peaks(sut, {1.009, 10.0}), 0) << part;
  }
}

// No signal of 1.6 m/s^2 RMS has a peak below that.
TEST(PeakLimitTest, AnImpossibleBoundIsRefused) {
  auto sut = band_noise(profile_of(MotionKind::kBandNoise));
  EXPECT_THROW(limit_peaks(sut, {1.6, 0.15}), ConfigError);
}

}  // namespace stillhand::motion::excitation_test
