// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/unit/diagnosis/made_multisine.hpp"

namespace stillhand::diagnosis::detection_lines_test {

constexpr std::size_t kPeriod = 1000;
const std::vector<std::size_t> kOdd{1, 5, 7, 11, 15, 17, 21, 25};  // 3, 9, 13, 19, 23 left out
const std::vector<std::size_t> kAll{2, 3, 5, 8, 9, 12, 14, 15};

// The first second isn't judged, the periods behind it are whole.
constexpr std::size_t count_of(std::size_t periods) { return periods * kPeriod + 100; }

// The residual is noise and a distortion of the input; the output is u and the residual.
DetectionLines lines_of(
    const std::vector<std::size_t>& harmonics, std::size_t periods,
    const std::vector<double>& noise,
    const std::function<double(double)>& distortion = [](double) { return 0.0; }) {
  const std::size_t count = count_of(periods);
  const std::vector<double> u = made::multisine(count, kPeriod, harmonics, 1);
  std::vector<double> y = u;
  Eigen::VectorXd residual(static_cast<Eigen::Index>(count));
  for (std::size_t n = 0; n < count; ++n) {
    const double r = noise[n] + distortion(u[n]);
    residual[static_cast<Eigen::Index>(n)] = r;
    y[n] += r;
  }
  const Signals signals = made::signals_of(u, y);
  const auto excitation = periodic_excitation_of(signals);
  EXPECT_TRUE(excitation.has_value());
  const auto repeated =
      repeated_residual(excitation->periodicity, residual, std::vector<double>(count, 1.0));
  EXPECT_TRUE(repeated.has_value());
  return detection_lines(*repeated, excitation->excited, signals);
}

// Of so many periods, with that deviation.
std::vector<double> white(std::size_t periods, std::uint64_t seed, double deviation) {
  return made::mix({{deviation, made::white(count_of(periods), seed)}});
}

TEST(DetectionLinesTest, LinesAreSortedByWhatIsExcited) {
  const DetectionLines sut = lines_of(kOdd, 4, white(4, 2, 0.1));
  EXPECT_NEAR(sut.fundamental_hz, 0.1, 1e-12);
  EXPECT_TRUE(sut.odd_excitation);
  EXPECT_EQ(sut.excited.frequency_hz.size(), kOdd.size());
  // Odd ones to 3 x 25 = 75: 38 less 8; even ones to 50: 25.
  EXPECT_EQ(sut.odd.frequency_hz.size(), 30u);
  EXPECT_EQ(sut.even.frequency_hz.size(), 25u);
  EXPECT_TRUE(sut.odd_or_even.empty());
  EXPECT_NEAR(sut.odd.frequency_hz.front(), 0.3, 1e-12);
  EXPECT_NEAR(sut.even.frequency_hz.front(), 0.2, 1e-12);
  // Each of 8 lines of an input of RMS 1 has 1/sqrt 8.
  EXPECT_NEAR(sut.excited.output.front(), 1.0 / std::sqrt(8.0), 0.02);
  // Six times 1, 3 and 7: these are odd.
  const DetectionLines sixth = lines_of({6, 18, 42}, 3, white(3, 3, 0.1));
  EXPECT_NEAR(sixth.fundamental_hz, 0.6, 1e-12);
  EXPECT_TRUE(sixth.odd_excitation);
}

TEST(DetectionLinesTest, ASquareIsEvenAndACubeIsOdd) {
  const auto noise = white(4, 4, 0.05);
  const DetectionLines square = lines_of(kOdd, 4, noise, [](double u) { return 0.05 * u * u; });
  EXPECT_LT(square.even.p, 1e-10);
  EXPECT_GT(square.even.share, 0.2);
  EXPECT_GT(square.odd.p, 1e-3);
  EXPECT_LT(std::abs(square.odd.share), 0.02);
  const DetectionLines cube = lines_of(kOdd, 4, noise, [](double u) { return 0.05 * u * u * u; });
  EXPECT_LT(cube.odd.p, 1e-10);
  EXPECT_GT(cube.odd.share, 0.1);
  EXPECT_GT(cube.even.p, 1e-3);
}

// Line j has the power (j mod 12)^2, and harmonics lie 12 lines apart.  The 8 lines on each side of
// one have 43.5 in the mean: (1 + .. + 8^2 and 4^2 + .. + 11^2)/16.  The even harmonics 2, 4 and 6
// have 435, ten times that; the 11 lines between two harmonics have 506 together, 50 times.
// Fisher's sum, 2 h, is chi-squared with six degrees of freedom.
TEST(DetectionLinesTest, AGroupIsComparedWithTheLinesAroundItsOwn) {
  constexpr double kSamples = 1200.0;
  RepeatedResidual repeated{{100, 100, 12, 0.0}, {}, {}};
  for (std::size_t j = 0; j <= 600; ++j) repeated.lines.emplace_back(j % 12);
  for (const std::size_t j : {24, 48, 72}) repeated.lines[j] = std::sqrt(435.0);
  const auto lines_at = [&](double output) {
    const std::vector<double> y = made::scaled_to(made::multisine(1300, 100, {2}, 1), output);
    return detection_lines(repeated, {1, 3}, made::signals_of(made::white(1300, 1), y));
  };
  const LineGroup sut = lines_at(1.0).even;
  EXPECT_THAT(sut.frequency_hz, testing::ElementsAre(2.0, 4.0, 6.0));
  EXPECT_THAT(lines_at(1.0).odd.frequency_hz, testing::ElementsAre(5.0, 7.0, 9.0));
  EXPECT_NEAR(sut.output.front(), 1.0, 1e-9);
  EXPECT_NEAR(sut.residual.front(), std::sqrt(2.0 * 435.0) / kSamples, 1e-12);
  EXPECT_NEAR(sut.noise.front(), std::sqrt(2.0 * 43.5) / kSamples, 1e-12);
  EXPECT_NEAR(sut.share, 3.0 * 391.5 / (50.0 * 506.0 + 3.0 * 435.0), 1e-12);
  const double h = 3.0 * 16.0 * std::log1p(10.0 / 16.0);
  EXPECT_NEAR(sut.p, std::exp(-h) * (1.0 + h + h * h / 2.0), 1e-6 * sut.p);
  // A thousandth of the output, whose one line has N^2/2 times its square, is not tested.
  const double level = 1e3 * std::sqrt(3.0 * 391.5 * 2.0) / kSamples;
  EXPECT_EQ(lines_at(0.99 * level).even.p, sut.p);
  EXPECT_EQ(lines_at(1.01 * level).even.p, 1.0);
}

TEST(DetectionLinesTest, WhereEvenLinesAreExcitedTheOrdersAreNotToldApart) {
  const DetectionLines sut =
      lines_of(kAll, 4, white(4, 6, 0.05), [](double u) { return 0.05 * u * u; });
  EXPECT_FALSE(sut.odd_excitation);
  EXPECT_TRUE(sut.odd.empty());
  EXPECT_TRUE(sut.even.empty());
  EXPECT_LT(sut.odd_or_even.p, 1e-10);
}

// How many of 400 recordings of noise alone have p below 5 %, both groups.
int alarms(std::size_t periods, const std::vector<double>& colour, bool heavy) {
  int count = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    auto noise = made::answer({0.1}, colour, made::white(count_of(periods), 2000 + seed));
    if (heavy) {
      for (double& value : noise) value *= value * value * 100.0;
    }
    const DetectionLines sut = lines_of(kOdd, periods, noise);
    count += sut.odd.p < 0.05 ? 1 : 0;
    count += sut.even.p < 0.05 ? 1 : 0;
  }
  return count;
}

// 5 % of 800 are 40 with a deviation of 6.2; 3.5 of these.  Where a group's lines hold less than
// noise would, p isn't looked at; that is never among the 5 %.
TEST(DetectionLinesTest, NoiseAloneGivesAlarmsAsOftenAsPSays) {
  EXPECT_NEAR(alarms(2, {1.0}, false), 40, 22);
  EXPECT_NEAR(alarms(6, {1.0}, false), 40, 22);
  // Slow noise is no different, level by level.
  EXPECT_NEAR(alarms(4, {1.0, -0.95}, false), 40, 22);
  // Heavy tails: cubes of normal deviates.
  EXPECT_NEAR(alarms(4, {1.0}, true), 40, 22);
}

// A ramp over the record is the same within every period, and yet no line; a tone between two
// harmonics leaks to both sides.
TEST(DetectionLinesTest, ADriftOrAToneBetweenTheLinesIsNoDistortion) {
  for (const auto& more :
       {+[](double n) { return 1e-3 * n; }, +[](double n) { return std::sin(0.0643 * n); }}) {
    std::vector<double> noise = white(4, 7, 0.05);
    for (std::size_t n = 0; n < noise.size(); ++n) noise[n] += more(static_cast<double>(n));
    const DetectionLines sut = lines_of(kOdd, 4, noise);
    EXPECT_GT(sut.odd.p, 0.01);
    EXPECT_GT(sut.even.p, 0.01);
  }
}

}  // namespace stillhand::diagnosis::detection_lines_test
