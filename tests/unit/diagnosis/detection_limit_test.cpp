// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/statistics/signed_rank.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis {
namespace {

TEST(DetectionLimitTest, ASampleOfSlowNoiseHoldsLessThanAnIndependentOne) {
  constexpr std::size_t kCount = 40000;
  const std::vector<double> e = made::white(kCount, 1);
  const Eigen::Map<const Eigen::VectorXd> white(e.data(), kCount);
  EXPECT_EQ(correlation_samples(white, 100.0), 1.0);
  // r(n) = 0.9 r(n-1) + e(n): 1 + 2 x 0.9/(1 - 0.9) = 19, without what is below 0.05: 18.
  Eigen::VectorXd slow = white;
  for (Eigen::Index n = 1; n < slow.size(); ++n) slow[n] += 0.9 * slow[n - 1];
  EXPECT_NEAR(correlation_samples(slow, 100.0), 18.0, 2.0);
}

RoundEvidence round_of(double independent, std::size_t blocks = 30) {
  return {.rmse = 2.0, .independent = independent, .blocks = blocks, .candidates = 44};
}

TEST(DetectionLimitTest, ItFallsWithTheSamplesUntilTheLeastFallDecides) {
  const SearchOptions options;
  const double few = detection_limit(round_of(1000.0), options);
  EXPECT_NEAR(detection_limit(round_of(4000.0), options), few / 2.0, 1e-12);
  // A fall of 0.5 %: 1/0.995^2 - 1 = 0.0101 of the power.
  EXPECT_NEAR(detection_limit(round_of(1e9), options), 2.0 * std::sqrt(0.010075), 1e-4);
}

// With ten blocks p cannot fall below 2^-10: only the rule for large effects is left, with a fall
// of 15 %: 1/0.85^2 - 1 = 0.384 of the power.
TEST(DetectionLimitTest, WithFewBlocksOnlyLargeEffectsAreFound) {
  EXPECT_NEAR(detection_limit(round_of(1e6, 10), {}), 2.0 * std::sqrt(0.3841), 1e-3);
}

// By simulation: effects of that size, white like the noise, in blocks, by the rule of the search.
TEST(DetectionLimitTest, AnEffectOfThatSizePassesTheRuleAboutAsOftenAsNot) {
  constexpr int kTrials = 2000;
  constexpr std::size_t kBlocks = 30;
  constexpr std::size_t kLength = 100;
  const SearchOptions options;
  const RoundEvidence round{.rmse = 1.0,
                            .independent = static_cast<double>(kBlocks * kLength),
                            .blocks = kBlocks,
                            .candidates = 44};
  signal::Gaussian next(7, 0);
  const auto share_found = [&](double size) {
    int found = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> differences(kBlocks, 0.0);
      for (double& difference : differences) {
        for (std::size_t n = 0; n < kLength; ++n) {
          const double effect = size * next();
          const double noise = next();
          difference += (noise + effect) * (noise + effect) - noise * noise;
        }
      }
      if (statistics::signed_rank_p(differences) * static_cast<double>(round.candidates) <
          options.significance) {
        ++found;
      }
    }
    return static_cast<double>(found) / kTrials;
  };
  const double limit = detection_limit(round, options);
  // The exact tail is lighter than the normal one that the equation takes.
  EXPECT_GT(share_found(limit), 0.4);
  EXPECT_LT(share_found(limit), 0.75);
  EXPECT_GT(share_found(1.5 * limit), 0.97);
  EXPECT_LT(share_found(0.6 * limit), 0.05);
}

// Slow noise has few independent samples. Behind the noise model it has as many as white noise and
// is smaller than white noise of the same RMS.
TEST(DetectionLimitTest, SlowNoiseIsWhitenedBeforeTheLimitIsTaken) {
  constexpr std::size_t kCount = 12000;
  const std::vector<double> input = made::white(kCount, 3);
  const std::vector<double> e = made::white(kCount, 4);
  const auto limit_under = [&](double pole) {
    std::vector<double> force(kCount, 0.0);
    double noise = 0.0;
    for (std::size_t n = 0; n < kCount; ++n) {
      noise = pole * noise + std::sqrt(1.0 - pole * pole) * e[n];
      force[n] = input[n] + 0.2 * noise;
    }
    const Measurement measurement =
        made::measurement_of({{"a_y", "m/s^2", input}, {"f", "N", force}});
    return diagnose(measurement, {}).detection_limit;
  };
  const double white = limit_under(0.0);
  // e(n) of r(n) = 0.98 r(n-1) + e(n) is 0.199 of r, and 99 samples hold as much as one would.
  EXPECT_LT(limit_under(0.98), white);
}

TEST(DetectionLimitTest, EachKindHasASizeOfItsOwn) {
  Diagnosis diagnosis;
  diagnosis.detection_limit = 0.1;
  EXPECT_DOUBLE_EQ(diagnosis.detection_limit_of(effect_kind("tone")), 0.1);
  EXPECT_DOUBLE_EQ(diagnosis.detection_limit_of(effect_kind("transients")), 0.6);
}

}  // namespace
}  // namespace stillhand::diagnosis
