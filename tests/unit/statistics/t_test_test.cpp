// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/t_test.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::t_test_test {
namespace {

namespace golden = stillhand::golden::statistics;
using support::agrees;
using support::golden_trials;

template <class Row>
void expect_equal(const TTest& sut, const Row& want) {
  EXPECT_TRUE(agrees(sut.mean_difference, want.mean));
  EXPECT_TRUE(agrees(sut.standard_deviation, want.deviation));
  EXPECT_TRUE(agrees(sut.t, want.t));
  EXPECT_EQ(sut.degrees_of_freedom, want.degrees);
  EXPECT_EQ(static_cast<double>(sut.n), want.degrees + 1.0);
  EXPECT_TRUE(agrees(sut.p, want.p));
  EXPECT_TRUE(agrees(sut.ci_low, want.low));
  EXPECT_TRUE(agrees(sut.ci_high, want.high));
  EXPECT_EQ(sut.confidence, want.confidence);
  EXPECT_TRUE(agrees(sut.cohen_dz, want.dz));
  ASSERT_TRUE(sut.hedges_gz.has_value());
  EXPECT_TRUE(agrees(*sut.hedges_gz, want.gz));
}

// The test of one sample: each value is paired with the reference.
TTest test_against(double reference, const std::vector<double>& values, double confidence = 0.95) {
  return paired_t_test(values, std::vector<double>(values.size(), reference), confidence);
}

TEST(TTestTest, PairedTestEqualsR) {
  double smallest = 1.0;
  for (const auto& want : golden::kPaired) {
    SCOPED_TRACE("set " + std::to_string(want.set) + ", metric " + std::to_string(want.metric));
    const auto trials = golden_trials(want.set);
    const TTest sut = paired_t_test(trials.under(want.first, want.metric),
                                    trials.under(want.second, want.metric), want.confidence);
    expect_equal(sut, want);
    smallest = std::min(smallest, sut.p);
  }
  EXPECT_LT(smallest, 1e-20) << "the sets no longer test the far tail";
}

TEST(TTestTest, OneSampleTestEqualsR) {
  for (const auto& want : golden::kOneSample) {
    SCOPED_TRACE("metric " + std::to_string(want.metric));
    expect_equal(test_against(want.reference, golden_trials(0).all(want.metric), 0.9), want);
  }
}

// With one degree of freedom T is Cauchy: P(|T| >= t) = 2/pi atan(1/t).  t here is
// mean / half difference.
TEST(TTestTest, TwoPairsFollowTheCauchyDistribution) {
  for (const double half_difference : {2.0, 1e-3, 1e-9}) {
    const TTest sut = test_against(0.0, {1.0 - half_difference, 1.0 + half_difference});
    // 1 +- 1e-9 is stored to 1e-16: 1e-7 of the difference.
    const double bound = half_difference < 1e-6 ? 1e-6 : 1e-12;
    const double want = 2.0 / std::numbers::pi * std::atan(half_difference);
    EXPECT_NEAR(sut.p / want, 1.0, bound);
    EXPECT_FALSE(sut.hedges_gz.has_value());
  }
}

// P(|T| >= t) = 1 - t / sqrt(2 + t^2) with two degrees of freedom; its tail goes with 1/t^2.
TEST(TTestTest, ProbabilityHoldsItsDigitsInTheFarTail) {
  // Differences 1, 1 + d, 1 - d with d = 2^-45: mean 1, s = d, t = sqrt(3) 2^45, all exact but t.
  const double d = std::ldexp(1.0, -45);
  const TTest sut = test_against(0.0, {1.0, 1.0 + d, 1.0 - d});
  // 1 / t^2 (1 - 3 / (2 t^2) ...), the rest below 1e-27.
  EXPECT_NEAR(sut.p * 3.0 / (d * d), 1.0, 1e-12);
}

TEST(TTestTest, SwappingTheSamplesChangesSignsAlone) {
  const auto trials = golden_trials(0);
  const TTest sut = paired_t_test(trials.under(0, 0), trials.under(1, 0));
  const TTest swapped = paired_t_test(trials.under(1, 0), trials.under(0, 0));
  EXPECT_EQ(sut.t, -swapped.t);
  EXPECT_EQ(sut.p, swapped.p);
  EXPECT_EQ(sut.ci_low, -swapped.ci_high);
  EXPECT_EQ(*sut.hedges_gz, -*swapped.hedges_gz);
}

TEST(TTestTest, HedgesCorrectionHoldsForManySubjects) {
  // J = 1 - 3/(4v) + O(1/v^2), the next term 7/(32 v^2) (Stirling's series): 2e-9 at v = 9999.
  std::vector<double> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 2 == 0 ? 2.0 : 0.0;
  const TTest sut = test_against(0.0, values);
  EXPECT_NEAR(*sut.hedges_gz / sut.cohen_dz, 1.0 - 3.0 / (4.0 * 9999.0), 1e-8);
  EXPECT_LT(*sut.hedges_gz, sut.cohen_dz);
}

TEST(TTestTest, DifferencesWithoutVarianceAreRefused) {
  EXPECT_THROW(paired_t_test({1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}), ConfigError);
  // Differences of 0.1 in decimals, not in binary: 0.1, 0.1 + 1e-16, 0.1 - 2e-16 or so.
  EXPECT_THROW(paired_t_test({0.2, 0.3, 0.7}, {0.1, 0.2, 0.6}), ConfigError);
  EXPECT_NO_THROW(paired_t_test({0.2, 0.3, 0.7}, {0.1, 0.2, 0.6 + 1e-12}));
  EXPECT_EQ(support::refusal([&] { paired_t_test({1.0, 1.0}, {2.0, 2.0}); }),
            "t_test.differences: got no variance (all are the same within rounding), want "
            "differences that vary");
}

TEST(TTestTest, UnusableSamplesAreRefused) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  EXPECT_THROW(paired_t_test({}, {}), ConfigError);
  EXPECT_THROW(paired_t_test({1.0}, {2.0}), ConfigError);
  EXPECT_THROW(paired_t_test({1.0, 2.0, 4.0}, {2.0, 2.0}), ConfigError);
  EXPECT_THROW(paired_t_test({1.0, nan}, {2.0, 2.0}), ConfigError);
  EXPECT_THROW(paired_t_test({1.0, 2.0}, {2.0, infinite}), ConfigError);
  for (const double outside : {0.0, 1.0, 95.0, nan}) {
    EXPECT_THROW(paired_t_test({1.0, 3.0}, {2.0, 2.0}, outside), ConfigError);
  }
}

// Eq. ST-18: scipy.stats.ttest_ind(equal_var=False) of SciPy 1.10; degrees of freedom and interval
// with numpy.var(ddof=1) and scipy.stats.t.ppf.
TEST(WelchTestTest, AgreesWithSciPy) {
  const WelchTest sut = welch_t_test({23.1, 25.4, 22.8, 27.9, 24.0}, {30.2, 28.1, 35.7});
  EXPECT_NEAR(sut.t, -2.7318488985508087, 1e-13);
  EXPECT_NEAR(sut.p, 0.08084565529088143, 1e-13);
  EXPECT_NEAR(sut.degrees_of_freedom, 2.695353465807146, 1e-12);
  EXPECT_NEAR(sut.ci_low, -15.013759937894301, 1e-10);
  EXPECT_NEAR(sut.ci_high, 1.627093271227631, 1e-10);
}

TEST(WelchTestTest, RefusesSamplesThatCannotBeTested) {
  EXPECT_THROW(welch_t_test({1.0}, {1.0, 2.0}), ConfigError);
  EXPECT_THROW(welch_t_test({1.0, 1.0}, {2.0, 2.0}), ConfigError);
  EXPECT_THROW(welch_t_test({1.0, 2.0}, {2.0, 3.0}, 1.0), ConfigError);
}

}  // namespace
}  // namespace stillhand::statistics::t_test_test
