// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/power.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/statistics/t_test.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::power_test {
namespace {

namespace golden = stillhand::golden::statistics;
using support::agrees;

constexpr double kAlphas[] = {0.05, 0.01, 0.001};  // of the golden columns

// R cuts the series of its noncentral t at 1e-12, a billionth of the smallest power here (1e-3).
TEST(PowerTest, EqualsR) {
  for (const auto& [dz, subjects, powers] : golden::kPowers) {
    for (std::size_t i = 0; i < std::size(powers); ++i) {
      EXPECT_TRUE(
          agrees(paired_t_power(dz, static_cast<std::size_t>(subjects), kAlphas[i]), powers[i]))
          << "dz " << dz << ", n " << subjects << ", alpha " << kAlphas[i];
    }
  }
}

TEST(PowerTest, SubjectsNeededEqualR) {
  for (const auto& [dz, power, subjects] : golden::kSubjects) {
    for (std::size_t i = 0; i < std::size(subjects); ++i) {
      EXPECT_EQ(subjects_for_power(dz, power, kAlphas[i]), static_cast<std::size_t>(subjects[i]))
          << "dz " << dz << ", power " << power << ", alpha " << kAlphas[i];
    }
  }
}

TEST(PowerTest, WithoutAnEffectThePowerIsTheLevelAndItIsEven) {
  for (const double alpha : {0.05, 1e-3, 1e-9}) {
    EXPECT_EQ(paired_t_power(0.0, 12, alpha), alpha);
    // Power is even in dz: 1e-8 changes it by (dz t)^2 n of its value at most, 1e-11 here.
    EXPECT_TRUE(agrees(paired_t_power(1e-8, 12, alpha), alpha));
  }
  // Nor does its sign matter.
  EXPECT_EQ(paired_t_power(-0.6, 12), paired_t_power(0.6, 12));
  EXPECT_EQ(subjects_for_power(-0.6, 0.9), subjects_for_power(0.6, 0.9));
}

// With two subjects V is chi-squared of one degree of freedom, P(V <= a^2) = erf(a / sqrt(2)), so
//   power = integral of phi(z) erf((z + delta) / (sqrt(2) t)) dz,   t = cot(pi alpha / 2) (Cauchy),
// but for z < -delta, whose weight is below 1e-170 here.  phi is 1e-23 at the ends, and for a
// smooth integrand that vanishes there the trapezoid's error is below rounding at this step.
TEST(PowerTest, TwoSubjectsFollowTheIntegralForStrongEffects) {
  for (const double alpha : {0.05, 0.001, 1e-6}) {
    const double critical = 1.0 / std::tan(std::numbers::pi * alpha / 2.0);
    for (const double dz : {20.0, 60.0, 100.0}) {
      const double delta = dz * std::sqrt(2.0);
      double want = 0.0;
      for (int i = -1000; i <= 1000; ++i) {
        const double z = 0.01 * i;
        want += 0.01 * std::exp(-z * z / 2.0) / std::sqrt(2.0 * std::numbers::pi) *
                std::erf((z + delta) / (std::sqrt(2.0) * critical));
      }
      EXPECT_TRUE(agrees(paired_t_power(dz, 2, alpha), want)) << dz << " " << alpha;
    }
  }
}

TEST(PowerTest, StaysAProbabilityForEveryEffectAndNumber) {
  for (const double alpha : {0.5, 0.05, 1e-12, 1e-200}) {
    for (const std::size_t n : {2u, 3u, 12u, 200u, 5000u, 1000000u}) {
      double before = 0.0;
      for (const double dz : {0.0, 1e-9, 0.01, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0}) {
        const double sut = paired_t_power(dz, n, alpha);
        // Grows with the effect, but for the rounding of a sum of many terms.
        EXPECT_GE(sut, before * (1.0 - 1e-10)) << alpha << " " << n << " " << dz;
        EXPECT_LE(sut, 1.0) << alpha << " " << n << " " << dz;
        before = sut;
      }
      EXPECT_TRUE(n < 200 || before == 1.0) << alpha << " " << n;
    }
  }
}

TEST(PowerTest, GrowsWithTheNumberOfSubjects) {
  double before = 0.0;
  for (std::size_t n = 2; n < 600; n += 7) {
    const double sut = paired_t_power(0.15, n, 0.01);
    EXPECT_GT(sut, before) << n;
    before = sut;
  }
}

TEST(PowerTest, AgreesWithSimulatedStudies) {
  // 4000 studies of 12 subjects, dz = 0.9: the count is binomial, and five standard deviations of
  // its share are 5 sqrt(0.8 * 0.2 / 4000) = 0.032.
  constexpr int kStudies = 4000;
  signal::Gaussian deviates(20110104, 0);
  int significant = 0;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> differences(12);
    for (double& d : differences) d = 0.9 + deviates();
    significant += paired_t_test(differences, std::vector<double>(12)).p < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(significant) / kStudies, paired_t_power(0.9, 12), 0.032);
}

TEST(PowerTest, ArgumentsOutsideAreRefused) {
  const double nan = std::nan("");
  EXPECT_THROW(paired_t_power(nan, 12), ConfigError);
  EXPECT_THROW(paired_t_power(-100.5, 12), ConfigError);
  EXPECT_THROW(paired_t_power(0.5, 1), ConfigError);
  EXPECT_THROW(paired_t_power(0.5, 1000001), ConfigError);
  EXPECT_THROW(paired_t_power(0.5, 12, 0.0), ConfigError);
  EXPECT_THROW(paired_t_power(0.5, 12, 1.0), ConfigError);
  EXPECT_THROW(subjects_for_power(0.5, 1.0), ConfigError);
  EXPECT_THROW(subjects_for_power(0.5, nan), ConfigError);
  // Power 0.8 takes n = (2.8 / dz)^2, 7.8 million here.
  EXPECT_THROW(subjects_for_power(0.001, 0.8), ConfigError);
}

}  // namespace
}  // namespace stillhand::statistics::power_test
