// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::signal::reference_test {
namespace {

TEST(ReferenceDesignTest, IsThePapersAtThreeMinutes) {
  const std::array<std::int64_t, kReferenceLines> printed{2,  3,  5,   7,   11,  17,  23, 37,
                                                          59, 87, 131, 199, 310, 467, 719};
  const ReferenceDesign sut = reference_design(180.0);
  EXPECT_EQ(sut.harmonics, printed);
  EXPECT_DOUBLE_EQ(sut.amplitudes[0], 0.75);
  EXPECT_DOUBLE_EQ(sut.amplitudes[14], 0.75 * std::exp(-1.96));
}

// Eq. SG-14 by hand: the multiples of 180 s times T/180 s, each at least one above the one before.
// Coprime: the nearest prime above the one before; of two equally near the smaller (29 for 30, 239
// for 240).
TEST(ReferenceDesignTest, ShorterTrialsHaveTheHarmonicsOfTheEquation) {
  using Harmonics = std::array<std::int64_t, kReferenceLines>;
  EXPECT_EQ(reference_design(10.0).harmonics,
            (Harmonics{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 17, 26, 40}));
  EXPECT_EQ(reference_design(20.0).harmonics,
            (Harmonics{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 15, 22, 34, 52, 80}));
  EXPECT_EQ(reference_design(60.0).harmonics,
            (Harmonics{1, 2, 3, 4, 5, 6, 8, 12, 20, 29, 44, 66, 103, 156, 240}));
  EXPECT_EQ(reference_design(60.0, ReferenceSet::kCoprime).harmonics,
            (Harmonics{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 43, 67, 103, 157, 239}));
  EXPECT_EQ(reference_design(180.0, ReferenceSet::kCoprime).harmonics,
            (Harmonics{2, 3, 5, 7, 11, 17, 23, 37, 59, 89, 131, 199, 311, 467, 719}));
}

TEST(ReferenceDesignTest, HarmonicsRiseAtEveryDuration) {
  for (const double duration_s : {5.0, 10.0, 20.0, 47.3, 60.0, 180.0, 600.0, 3600.0}) {
    for (const auto set : {ReferenceSet::kPaper, ReferenceSet::kCoprime}) {
      const ReferenceDesign sut = reference_design(duration_s, set);
      EXPECT_GE(sut.harmonics[0], 1);
      for (std::size_t k = 1; k < kReferenceLines; ++k) {
        EXPECT_GT(sut.harmonics[k], sut.harmonics[k - 1]) << duration_s;
      }
    }
  }
}

TEST(ReferenceDesignTest, OnlyTheCoprimeSetIsCoprime) {
  const auto shared = [](const ReferenceDesign& design) {
    int pairs = 0;
    for (std::size_t i = 0; i < kReferenceLines; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        pairs += std::gcd(design.harmonics[i], design.harmonics[j]) > 1 ? 1 : 0;
      }
    }
    return pairs;
  };
  for (const double duration_s : {10.0, 20.0, 60.0, 180.0}) {
    EXPECT_EQ(shared(reference_design(duration_s, ReferenceSet::kCoprime)), 0) << duration_s;
  }
  // 87 with 3; 310 with 2 and 5.
  EXPECT_EQ(shared(reference_design(180.0)), 3);
}

TEST(ReferenceDesignTest, DurationOutsideItsRangeIsRefused) {
  EXPECT_THROW(reference_design(4.9), ConfigError);
  EXPECT_THROW(reference_design(3601.0), ConfigError);
  EXPECT_THROW(reference_design(std::nan("")), ConfigError);
}

TEST(ReferenceSignalTest, IsTheSumOfItsSines) {
  const ReferenceDesign design = reference_design(20.0);
  const ReferenceSignal sut(design, 20'000, 5, 0.04);
  for (Tick n = 0; n < 20'000; n += 37) {
    long double sum = 0.0L;
    for (std::size_t k = 0; k < kReferenceLines; ++k) {
      const long double turns = static_cast<long double>(design.harmonics[k] * n % 20'000) / 20'000;
      sum += 0.04L * design.amplitudes[k] *
             std::sin(2.0L * std::numbers::pi_v<long double> * turns + sut.phases_rad()[k]);
    }
    // Stated: 1e-15 of the scale a line.
    ASSERT_NEAR(sut.at(n), static_cast<double>(sum), 15 * 1e-15 * 0.04) << n;
  }
}

TEST(ReferenceSignalTest, EveryLineHasItsAmplitudeAndNothingElseIsThere) {
  const ReferenceDesign design = reference_design(60.0);
  const ReferenceSignal sut(design, 60'000, 8, 1.0);
  std::vector<double> x;
  for (Tick n = 0; n < 60'000; ++n) x.push_back(sut.at(n));
  for (std::size_t k = 0; k < kReferenceLines; ++k) {
    EXPECT_NEAR(std::abs(line_at(x, design.harmonics[k])), design.amplitudes[k], 1e-13);
  }
  EXPECT_NEAR(std::abs(line_at(x, 100)), 0.0, 1e-13);
  // Whole cycles: zero mean, as the paper asks.
  EXPECT_NEAR(std::accumulate(x.begin(), x.end(), 0.0) / 60'000.0, 0.0, 1e-14);
  const auto [least, most] = std::ranges::minmax(x);
  EXPECT_EQ(sut.peak_m(), std::max(-least, most));
}

TEST(ReferenceSignalTest, IsPeriodicBothWays) {
  const ReferenceSignal sut(reference_design(10.0), 10'000, 1, 0.02);
  for (const Tick n : {Tick{0}, Tick{1}, Tick{4321}, Tick{9999}}) {
    EXPECT_EQ(sut.at(n), sut.at(n + 10'000));
    EXPECT_EQ(sut.at(n), sut.at(n - 10'000));
    EXPECT_EQ(sut.at(n), sut.at(n - 50'000));
  }
}

TEST(ReferenceSignalTest, SeedDecidesThePhases) {
  const ReferenceDesign design = reference_design(10.0);
  const ReferenceSignal first(design, 10'000, 1, 0.02);
  const ReferenceSignal same(design, 10'000, 1, 0.02);
  const ReferenceSignal other(design, 10'000, 2, 0.02);
  EXPECT_EQ(first.at(1234), same.at(1234));
  EXPECT_NE(first.at(1234), other.at(1234));
}

TEST(ReferenceSignalTest, WhatCannotBeSampledIsRefused) {
  EXPECT_THROW(ReferenceSignal(reference_design(180.0), 1438, 1, 0.02), ConfigError);
  EXPECT_NO_THROW(ReferenceSignal(reference_design(180.0), 1439, 1, 0.02));
  EXPECT_THROW(ReferenceSignal(reference_design(180.0), 0, 1, 0.02), ConfigError);
  EXPECT_THROW(ReferenceSignal(reference_design(180.0), 180'000, 1, std::nan("")), ConfigError);
  // A constant, and the line at half the rate, whose sine is 0 at every sample.
  ReferenceDesign constant = reference_design(180.0);
  constant.harmonics.front() = 0;
  EXPECT_THROW(ReferenceSignal(constant, 180'000, 1, 0.02), ConfigError);
  ReferenceDesign alternating = reference_design(180.0);
  alternating.harmonics.back() = 90'000;
  EXPECT_THROW(ReferenceSignal(alternating, 180'000, 1, 0.02), ConfigError);
  alternating.harmonics.back() = 89'999;
  EXPECT_NO_THROW(ReferenceSignal(alternating, 180'000, 1, 0.02));
}

}  // namespace
}  // namespace stillhand::signal::reference_test
