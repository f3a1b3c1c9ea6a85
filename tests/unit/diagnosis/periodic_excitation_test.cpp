// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/periodic_excitation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/made_measurement.hpp"
#include "tests/unit/diagnosis/made_multisine.hpp"

namespace stillhand::diagnosis::periodic_excitation_test {

Signals signals_of(const std::vector<double>& u) {
  return {made::measurement_of({{"u", "V", u}, {"y", "N", made::white(u.size(), 99)}}), {"u"}, "y"};
}

constexpr std::size_t kPeriod = 500;
const std::vector<std::size_t> kHarmonics{3, 5, 9, 11, 17, 21};

TEST(PeriodicExcitationTest, AMultisinesPeriodIsFoundToTheSample) {
  const auto sut = periodicity_of(signals_of(made::multisine(3200, kPeriod, kHarmonics, 1)));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->period, kPeriod);
  // 3200 samples less the first second, which is not judged: 6.2 periods, the last six taken.
  EXPECT_EQ(sut->periods, 6u);
  EXPECT_EQ(sut->end(), 3200u);
  EXPECT_LT(sut->deviation, 1e-20);
}

TEST(PeriodicExcitationTest, TwoPeriodsAreEnoughAndLessAreNot) {
  const auto periodic = [](std::size_t count) {
    return periodicity_of(signals_of(made::multisine(count, kPeriod, kHarmonics, 2))).has_value();
  };
  // The first second is not judged.
  EXPECT_TRUE(periodic(100 + 2 * kPeriod));
  EXPECT_FALSE(periodic(100 + 2 * kPeriod - 10));
}

TEST(PeriodicExcitationTest, ARestBeforeAndNoiseAfterAreCutOff) {
  std::vector<double> u = made::multisine(5000, kPeriod, kHarmonics, 3);
  const auto noise = made::ride(5000, 4);
  for (std::size_t n = 0; n < 700; ++n) u[n] = 0.0;
  for (std::size_t n = 4400; n < 5000; ++n) u[n] = noise[n];
  const auto sut = periodicity_of(signals_of(u));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->period, kPeriod);
  // To an eighth of a period at each end.
  EXPECT_GE(sut->first + kPeriod / 8, 700u);
  EXPECT_LE(sut->end(), 4400 + kPeriod / 8);
  EXPECT_GE(sut->periods, 6u);
}

// Ten of 33.3 samples are 333; three of them are 100 but for 0.1 of a sample, which shows.
TEST(PeriodicExcitationTest, OfAPeriodThatIsNotWholeAMultipleThatNearlyIsIsTaken) {
  std::vector<double> u(4000);
  for (std::size_t n = 0; n < u.size(); ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n) / 33.3;
    u[n] = std::sin(turn) + 0.5 * std::sin(3.0 * turn + 1.0);
  }
  const auto sut = periodicity_of(signals_of(u));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->period, 333u);
}

// Lines at 6.0, 6.2 .. 7.4 Hz: a cycle of the carrier later the input is nearly the same, but only
// 5 s later it is.
TEST(PeriodicExcitationTest, ABeatsCarrierIsNoPeriod) {
  const auto u = made::multisine(4000, 500, {30, 31, 32, 33, 34, 35, 36, 37}, 5);
  const auto sut = periodicity_of(signals_of(u));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->period, 500u);
}

// Noise of variance s on an input of variance 1: s/(1 + s) of it doesn't repeat.
TEST(PeriodicExcitationTest, SensorNoiseIsToleratedUpToAHundredthOfThePower) {
  const auto clean = made::multisine(4000, kPeriod, kHarmonics, 6);
  const auto noise = made::white(4000, 7);
  const auto with_noise = [&](double power) {
    std::vector<double> u = clean;
    for (std::size_t n = 0; n < u.size(); ++n) u[n] += std::sqrt(power) * noise[n];
    return periodicity_of(signals_of(u));
  };
  const auto little = with_noise(0.005);
  ASSERT_TRUE(little.has_value());
  EXPECT_EQ(little->period, kPeriod);
  // 3500 squared differences of variance 2 (2 s)^2 / 2: to within 0.0005 in 5 deviations.
  EXPECT_NEAR(little->deviation, 0.005, 0.0007);
  EXPECT_FALSE(with_noise(0.02).has_value());
}

// At lag L the correlation of 40 s of noise in 0.5 to 8 Hz, some 600 independent samples, has a
// deviation of 0.04: 0.99 does not occur.
TEST(PeriodicExcitationTest, NoiseIsNeverPeriodic) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    EXPECT_FALSE(periodicity_of(signals_of(made::ride(4000, seed))).has_value()) << seed;
  }
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_FALSE(periodicity_of(signals_of(made::ride(4000, seed, 0.2, 0.6))).has_value()) << seed;
  }
}

TEST(PeriodicExcitationTest, PeriodsAreNotCountedAcrossAGap) {
  const auto u = made::multisine(1900, kPeriod, kHarmonics, 8);
  const Measurement whole = made::measurement_of({{"u", "V", u}, {"y", "N", made::white(1900, 9)}});
  EXPECT_TRUE(periodicity_of(Signals(whole, {"u"}, "y")).has_value());
  const Measurement cut = made::cut_in_two(whole, 950, 0.3);
  EXPECT_FALSE(periodicity_of(Signals(cut, {"u"}, "y")).has_value());
}

TEST(PeriodicExcitationTest, SeveralInputsHaveTheirCommonPeriod) {
  const auto u = made::multisine(4000, 300, {2, 5, 7}, 10);
  const auto v = made::multisine(4000, 200, {1, 3, 4}, 11);
  const auto y = made::white(4000, 12);
  Measurement both = made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}});
  const auto sut = periodicity_of(Signals(both, {"u", "v"}, "y"));
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->period, 600u);
  both.channels[1].values = made::ride(4000, 13);
  EXPECT_FALSE(periodicity_of(Signals(both, {"u", "v"}, "y")).has_value());
}

}  // namespace stillhand::diagnosis::periodic_excitation_test
