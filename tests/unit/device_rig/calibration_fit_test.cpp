// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/calibration_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "services/core/contract/config_error.hpp"

namespace stillhand::device_rig::calibration_fit_test {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kShare = 0.02;

/// Steps of 0, 5, 10, -5, -10 and 0 N on a sensor of 0.02 V/N and 1.65 V at 0.
std::vector<CalibrationStep> steps() {
  std::vector<CalibrationStep> all;
  for (const double known : {0.0, 5.0, 10.0, -5.0, -10.0, 0.0}) {
    all.push_back({known, 1.65 + 0.02 * known, 0.001, 500});
  }
  return all;
}

// Eq. DR-15.
TEST(CalibrationFitTest, FindsAStraightLine) {
  const CalibrationFit fit = calibration_fit(steps());
  EXPECT_NEAR(fit.sensitivity, 0.02, 1e-15);
  EXPECT_NEAR(fit.zero, 1.65, 1e-15);
  EXPECT_NEAR(fit.residual, 0.0, 1e-12);
  EXPECT_NEAR(fit.noise, 0.05, 1e-12);
  EXPECT_DOUBLE_EQ(fit.low, -10.0);
  EXPECT_DOUBLE_EQ(fit.high, 10.0);
  EXPECT_THAT(calibration_fault(fit, kShare, "N"), IsEmpty());
}

// By hand: x = -1, 0, 1, -1; y = 0, 0, 3, 0.  Sxx = 2.75, Sxy = 3.75, so b = 15/11 and
// a = 3/4 + 15/44 = 12/11.  Residuals 3/11, -12/11, 6/11, 3/11: 18/11 in squares, 9/11 a freedom.
TEST(CalibrationFitTest, StatesTheStandardErrors) {
  const std::vector<CalibrationStep> all{{-1.0, 0.0}, {0.0, 0.0}, {1.0, 3.0}, {-1.0, 0.0}};
  const CalibrationFit fit = calibration_fit(all);
  EXPECT_NEAR(fit.sensitivity, 15.0 / 11.0, 1e-12);
  EXPECT_NEAR(fit.zero, 12.0 / 11.0, 1e-12);
  EXPECT_NEAR(fit.sensitivity_error, std::sqrt(9.0 / 11.0 / 2.75), 1e-12);
  EXPECT_NEAR(fit.zero_error, std::sqrt(9.0 / 11.0 * (0.25 + 0.0625 / 2.75)), 1e-12);
  EXPECT_NEAR(fit.residual, 12.0 / 15.0, 1e-12);
}

TEST(CalibrationFitTest, NamesWhatMakesItUseless) {
  auto turned = steps();
  for (CalibrationStep& step : turned) step.known = -step.known;
  EXPECT_THAT(calibration_fault(calibration_fit(turned), kShare, "N"), HasSubstr("must grow"));
  auto slipped = steps();
  slipped.back().reading += 0.02 * 0.5;
  EXPECT_THAT(
      calibration_fault(calibration_fit(slipped), kShare, "N"),
      AllOf(HasSubstr("reads 0.5 N away"), HasSubstr("more than 0.2 N: something slipped")));
  auto wrong = steps();
  wrong[2].reading += 0.02 * 2.0;
  EXPECT_THAT(calibration_fault(calibration_fit(wrong), kShare, "N"),
              ContainsRegex("a step is .* N off the straight line, more than 0.2 N"));
}

// A cable that is off: the mean of 500 samples still differs from step to step.
TEST(CalibrationFitTest, ASensorThatDoesNotReactIsNamed) {
  auto dead = steps();
  double off = 1e-5;
  for (CalibrationStep& step : dead) step.reading = 1.65 + (off *= -1.1);
  EXPECT_THAT(calibration_fault(calibration_fit(dead), kShare, "N"),
              HasSubstr("does not react: 10 N change the reading by no more than its noise"));
  // A noisy one that reacts.
  auto noisy = steps();
  for (CalibrationStep& step : noisy) step.spread = 0.9 * 0.2;
  EXPECT_THAT(calibration_fault(calibration_fit(noisy), kShare, "N"), IsEmpty());
}

TEST(CalibrationFitTest, RefusesStepsThatDetermineNoLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<CalibrationStep>> bad{
      {},
      {{0.0, 1.0}, {1.0, 2.0}, {0.0, 1.0}},
      {{0.0, 1.0}, {1.0, 2.0}, {2.0, 3.0}, {0.0, 1.0}},
      {{0.0, 1.0}, {-1.0, 0.0}, {-2.0, -1.0}, {0.0, 1.0}},
      {{0.0, 1.0}, {1.0, nan}, {-1.0, 0.0}},
      {{0.0, 1.0}, {1.0, 1.0}, {-1.0, 1.0}}};
  for (const auto& each : bad) EXPECT_THROW(calibration_fit(each), ConfigError);
}

}  // namespace stillhand::device_rig::calibration_fit_test
