// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/noise_floor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/diagnosis/made_multisine.hpp"

namespace stillhand::diagnosis::noise_floor_test {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr std::size_t kCount = 6000;
const std::vector<std::size_t> kHarmonics{5, 11, 15, 23, 31, 37, 45, 55};

// Body on u and noise of 0.05.
Measurement made_with(const std::vector<double>& u, const std::vector<double>& noise) {
  const auto answer = made::answer(made::two_pole_body(), u);
  const auto y = made::sum_of(answer, made::scaled_to(noise, 0.05));
  return made::measurement_of({{"u", "V", u}, {"y", "N", y}});
}

NoiseFloor floor_of(const Measurement& measurement) {
  const made::Studied studied(measurement, 2);
  return noise_floor_of(detected(studied.screening, periodic_excitation_of(studied.signals)),
                        studied.screening, {0.049, 0.051, 0.0502});
}

double estimate(const NoiseFloor& floor, const std::string& name) {
  for (const NoiseEstimate& each : floor.estimates) {
    if (each.name == name) return each.rmse;
  }
  return 0.0;
}

// 5900 samples of white noise determine its size to 1 % (one deviation), spectra of it to 2 %.
TEST(NoiseFloorTest, OfWhiteNoiseAllEstimatesAgree) {
  const NoiseFloor sut = floor_of(made_with(made::ride(kCount, 1), made::white(kCount, 2)));
  EXPECT_NEAR(sut.rmse, 0.05, 0.002);
  EXPECT_EQ(sut.estimates.front().name, "final model");
  EXPECT_EQ(estimate(sut, "repeats"), 0.0);
  EXPECT_NEAR(estimate(sut, "high frequencies"), 0.05, 0.004);
  EXPECT_NEAR(estimate(sut, "between blocks"), 0.05, 0.004);
  EXPECT_THAT(sut.method, StartsWith("the residual of the final model"));
  EXPECT_THAT(sut.method, HasSubstr("Other estimates: high frequencies 0.0"));
  EXPECT_THAT(sut.method, HasSubstr("between blocks 0.0"));
}

TEST(NoiseFloorTest, WhereTheExcitationRepeatsTheRepeatsAreUsed) {
  const NoiseFloor sut =
      floor_of(made_with(made::multisine(kCount, 1000, kHarmonics, 3), made::white(kCount, 4)));
  EXPECT_EQ(sut.estimates.front().name, "repeats");
  EXPECT_EQ(sut.rmse, sut.estimates.front().rmse);
  EXPECT_NEAR(sut.rmse, 0.05, 0.002);
  EXPECT_LT(sut.low, 0.05);
  EXPECT_GT(sut.high, 0.05);
  // 4000 degrees of freedom: 2.2 % to each side.
  EXPECT_NEAR((sut.high - sut.low) / sut.rmse, 0.044, 0.01);
  EXPECT_THAT(sut.method, StartsWith("repeats"));
  EXPECT_THAT(sut.method, HasSubstr("5 periods of the excitation (10 s each)"));
  EXPECT_THAT(sut.method, HasSubstr("final model 0.0"));
}

// What repeats and isn't explained stays out of the repeats, and in the others.
TEST(NoiseFloorTest, DistortionIsNotTakenForNoise) {
  const auto u = made::multisine(kCount, 1000, kHarmonics, 5);
  Measurement measurement = made_with(u, made::white(kCount, 6));
  std::vector<double>& y = measurement.channels[1].values;
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.1 * u[n] * u[n];
  const NoiseFloor sut = floor_of(measurement);
  EXPECT_NEAR(sut.rmse, 0.05, 0.002);
  EXPECT_GT(estimate(sut, "between blocks"), 0.07);
}

// Noise behind a low-pass of 0.5 Hz: 0.05 in all, next to nothing above 10 Hz.
TEST(NoiseFloorTest, SlowNoiseSpreadsTheEstimatesAndTheInterval) {
  const auto slow = made::answer({1.0}, {1.0, -0.97}, made::white(kCount, 8));
  const NoiseFloor sut = floor_of(made_with(made::ride(kCount, 7), slow));
  EXPECT_LT(estimate(sut, "high frequencies"), 0.02);
  EXPECT_EQ(sut.low, estimate(sut, "high frequencies"));
  EXPECT_GE(sut.high, sut.rmse);
  EXPECT_GT(sut.rmse, 0.04);
}

// An input up to half the rate leaves no band above it.
TEST(NoiseFloorTest, WithoutRoomAboveTheBandThereIsNoHighFrequencyEstimate) {
  const NoiseFloor sut = floor_of(made_with(made::white(kCount, 9), made::white(kCount, 10)));
  EXPECT_EQ(estimate(sut, "high frequencies"), 0.0);
  EXPECT_THAT(sut.method, Not(HasSubstr("high frequencies")));
  EXPECT_NEAR(estimate(sut, "between blocks"), 0.05, 0.004);
}

// A residual that is known, and answers that are made up.
struct Known {
  Known() : studied(made_with(made::ride(kCount, 1), made::white(kCount, 2)), 2) {}
  [[nodiscard]] NoiseFloor floor(const DetectionResult& after, const ErrorBounds& bounds) const {
    return noise_floor_of(after, studied.screening, bounds);
  }
  made::Studied studied;
};

const Known& known() {
  static const Known kKnown;
  return kKnown;
}

Detection explains(double share, bool found) { return {"linear in", "v", share, 1e-9, found, {}}; }

// 0.36 of the squared error explained: 0.8 of the error is left.
TEST(NoiseFloorTest, WhatAQuestionExplainsIsNoNoise) {
  const double all = known().floor({}, {}).rmse;
  DetectionResult after;
  after.detections = {explains(0.36, true), explains(0.2, true), explains(0.9, false)};
  EXPECT_NEAR(known().floor(after, {}).rmse, 0.8 * all, 1e-12 * all);
  after.detections = {explains(1.5, true)};
  EXPECT_EQ(known().floor(after, {}).rmse, 0.0) << "a share is at most all";
}

// Freed of its numbers: rmse sqrt(w/(w - k)), w the samples that count, k = 1 + 3 + 2.
TEST(NoiseFloorTest, TheFinalModelsErrorIsFreedOfItsNumbers) {
  const auto& screening = known().studied.screening;
  double weight = 0.0;
  for (const double each : screening.weight()) weight += each;
  EXPECT_NEAR(known().floor({}, {}).rmse, screening.rmse() * std::sqrt(weight / (weight - 6.0)),
              1e-12);
}

TEST(NoiseFloorTest, TheIntervalHoldsTheEstimateWhateverTheBounds) {
  const double rmse = known().floor({}, {}).rmse;
  for (const ErrorBounds& bounds :
       {ErrorBounds{0.9 * rmse, 1.2 * rmse, 0.0}, ErrorBounds{1.1 * rmse, 1.2 * rmse, 0.0},
        ErrorBounds{0.8 * rmse, 0.9 * rmse, 0.0},
        ErrorBounds{0.9 * rmse, 1.2 * rmse, 0.5 * rmse}}) {
    const NoiseFloor sut = known().floor({}, bounds);
    EXPECT_LE(sut.low, sut.rmse);
    EXPECT_GE(sut.high, sut.rmse);
    EXPECT_LE(sut.low, bounds.low);
  }
  EXPECT_DOUBLE_EQ(known().floor({}, {0.9 * rmse, 1.5 * rmse, 1.1 * rmse}).high, 1.1 * rmse)
      << "noise is at most what a long impulse response leaves";
}

TEST(NoiseFloorTest, TheIntervalReachesDownToTheLowestEstimate) {
  const double rmse = known().floor({}, {}).rmse;
  DetectionResult after;
  after.coherence.incoherent_rms = 0.25 * rmse;
  const NoiseFloor sut = known().floor(after, {0.9 * rmse, 1.2 * rmse, 0.0});
  EXPECT_EQ(sut.low, 0.25 * rmse);
  EXPECT_EQ(sut.rmse, rmse);
  after.coherence.incoherent_rms = 5.0 * rmse;
  EXPECT_EQ(known().floor(after, {0.9 * rmse, 1.2 * rmse, 0.0}).high, 1.2 * rmse)
      << "noise cannot be more than is left";
}

// Densities [N^2/Hz] of 0.001 f from f_1, 1.25 times the band's end, to 0.3 of the rate, 30 Hz, and
// 0.01 above; their mean, (f_1 + 30)/2000, is taken for what is below f_1.  A line of 0.05 Hz at
// the edges moves the root by less than 3e-3.
TEST(NoiseFloorTest, HighFrequenciesAreTakenForTheBandAsWell) {
  const double from_hz = 1.25 * known().studied.signals.highest_excited_hz();
  const double mean = (from_hz + 30.0) / 2000.0;
  DetectionResult after;
  for (int k = 20; k <= 1000; ++k) {
    const double at_hz = 0.05 * k;
    after.coherence.frequency_hz.push_back(at_hz);
    after.coherence.residual_density.push_back(
        at_hz <= from_hz ? 1000.0 * mean : (at_hz < 30.0 ? 0.001 * at_hz : 0.01));
  }
  const NoiseFloor sut = known().floor(after, {});
  EXPECT_NEAR(estimate(sut, "high frequencies"),
              std::sqrt(mean * from_hz + mean * (30.0 - from_hz) + 0.01 * 20.0), 3e-3);
  EXPECT_THAT(sut.method, HasSubstr("1000 times"));
}

}  // namespace stillhand::diagnosis::noise_floor_test
