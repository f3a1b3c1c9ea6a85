// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "services/core/diagnosis/unexplained.hpp"
#include "tests/unit/diagnosis/made_multisine.hpp"

namespace stillhand::diagnosis::detection_test {

constexpr std::size_t kCount = 6000;
constexpr double kNoise = 0.05;

using Addition = std::function<double(std::size_t n, double y, double v)>;

// Body on u, a channel v, white noise, and something more.
Measurement made_with(std::uint64_t seed, const Addition& more) {
  const auto u = made::ride(kCount, 3 * seed + 1);
  const auto v = made::ride(kCount, 3 * seed + 2);
  const auto noise = made::white(kCount, 3 * seed + 3);
  auto y = made::answer(made::two_pole_body(), u);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += kNoise * noise[n] + more(n, y[n], v[n]);
  return made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}});
}

DetectionResult detected_in(const Measurement& measurement) {
  const made::Studied studied(measurement, 2);
  return detected(studied.screening, periodic_excitation_of(studied.signals));
}

const Detection& asked(const DetectionResult& result, const std::string& question,
                       const std::string& channel) {
  for (const Detection& each : result.detections) {
    if (each.question == question && each.channel == channel) return each;
  }
  throw std::out_of_range(question + " " + channel);
}

void expect_silent(const DetectionResult& result, std::uint64_t seed) {
  for (const Detection& each : result.detections) {
    EXPECT_FALSE(each.found) << seed << ": " << each.question << " " << each.channel;
  }
}

// Nothing is added to noise of 0.05: none of some twenty questions answers with more than 6 % of
// the power and a p of 1 %.
TEST(DetectionTest, WhiteNoiseAnswersNoQuestion) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const DetectionResult sut = detected_in(made_with(seed, [](auto...) { return 0.0; }));
    EXPECT_GT(sut.detections.size(), 10u);
    expect_silent(sut, seed);
    // 99 % of a white residual's 100 lags lie within; six outside would be 5 standard deviations.
    EXPECT_LT(sut.whiteness.share_outside, 0.06);
    // Mean squares of 200 samples spread by 10 %: the largest of 30 within 1.3 of the median in
    // RMS.
    EXPECT_LT(sut.spread.largest_ratio, 1.3);
  }
}

TEST(DetectionTest, EveryPlantedDependenceIsFoundAndNamed) {
  struct Case {
    const char* question;
    const char* channel;
    Addition more;
    double least = 0.3;  // share
  };
  const Case cases[] = {
      {"linear in", "v", [](std::size_t, double, double v) { return 0.1 * v; }},
      {"square of", "v", [](std::size_t, double, double v) { return 0.1 * v * v; }},
      {"cube of", "v", [](std::size_t, double, double v) { return 0.05 * v * v * v; }},
      {"gain by", "v", [](std::size_t, double y, double v) { return 0.3 * v * y; }},
      {"square of", "the body's output", [](std::size_t, double y, double) { return 0.2 * y * y; }},
      {"cube of", "the body's output",
       [](std::size_t, double y, double) { return 0.1 * y * y * y; }},
      {"size of", "the body's output",
       [](std::size_t, double y, double) { return 0.3 * std::abs(y); }},
      {"sign of the rate of", "the body's output",
       [last = 0.0](std::size_t, double y, double) mutable {
         return std::copysign(0.1, y - std::exchange(last, y));
       }},
      {"damping by the size of", "the body's output",
       [last = 0.0](std::size_t, double y, double) mutable {
         return 0.1 * std::abs(y) * (y - std::exchange(last, y));
       }},
      // The last of eight half-cosines.
      {"gain over", "time",
       [](std::size_t n, double y, double) {
         return 0.3 * y * std::cos(8.0 * std::numbers::pi * static_cast<double>(n) / kCount);
       }},
      // 0.0142^2/(0.0142^2 + 0.05^2) = 7.5 % of the squared error, where 6 % are asked for.
      {"linear in", "v", [](std::size_t, double, double v) { return 0.0142 * v; }, kLeastShare},
  };
  for (const Case& each : cases) {
    SCOPED_TRACE(std::string(each.question) + " " + each.channel);
    Measurement measurement = made_with(20, each.more);
    // Far from 0: products are those of the deviations from the mean.
    for (double& value : measurement.channels[1].values) value += 4.0;
    const DetectionResult sut = detected_in(measurement);
    const Detection& found = asked(sut, each.question, each.channel);
    EXPECT_TRUE(found.found);
    EXPECT_GT(found.share, each.least);
    EXPECT_EQ(found.p, kSignificance) << "none of the surrogates";
    // Strongest first.
    EXPECT_TRUE(std::ranges::is_sorted(sut.detections, std::ranges::greater(), &Detection::share));
  }
}

// 0.1 of a white v at each of six lags, 0.06 of 0.0625 in power; without one of them 0.05.
TEST(DetectionTest, AChannelIsAskedAtSixLags) {
  Measurement measurement = made_with(21, [](auto...) { return 0.0; });
  std::vector<double>& v = measurement.channels[1].values = made::white(kCount, 22);
  for (std::size_t n = 80; n < kCount; ++n) {
    for (const std::size_t lag : {0, 5, 10, 20, 40, 80}) {
      measurement.channels[2].values[n] += 0.1 * v[n - lag];
    }
  }
  EXPECT_NEAR(asked(detected_in(measurement), "linear in", "v").share, 0.06 / 0.0625, 0.03);
}

TEST(DetectionTest, AProductOfTwoChannelsIsAskedForAllPairs) {
  const auto u = made::ride(kCount, 1);
  auto v = made::ride(kCount, 2);
  auto w = made::ride(kCount, 3);
  auto y =
      made::mix({{1.0, made::answer(made::two_pole_body(), u)}, {kNoise, made::white(kCount, 4)}});
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] += 0.2 * v[n] * w[n];
    v[n] += 4.0;
    w[n] -= 4.0;
  }
  const DetectionResult sut = detected_in(
      made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"w", "V", w}, {"y", "N", y}}));
  EXPECT_TRUE(asked(sut, "product of", "v and w").found);
  EXPECT_EQ(sut.detections.front().channel, "v and w");
  EXPECT_EQ(sut.detections.front().channels, (std::vector<std::string>{"v", "w"}));
  EXPECT_FALSE(asked(sut, "product of", "u and v").found);
}

// A square of what the input was over a second ago: no column is that, but the lines are.
TEST(DetectionTest, DistortionThatNoColumnShowsIsFoundAtTheLines) {
  const auto u = made::multisine(kCount, 1000, {5, 11, 15, 23, 31, 37, 45, 55}, 60);
  auto y =
      made::mix({{1.0, made::answer(made::two_pole_body(), u)}, {kNoise, made::white(kCount, 61)}});
  for (std::size_t n = 125; n < kCount; ++n) y[n] += 0.1 * u[n - 75] * u[n - 125];
  const DetectionResult sut = detected_in(made::measurement_of({{"u", "V", u}, {"y", "N", y}}));
  EXPECT_TRUE(asked(sut, kDistortion, "even lines").found);
  EXPECT_TRUE(asked(sut, kDistortion, "even lines").channels.empty());
  EXPECT_FALSE(asked(sut, kDistortion, "odd lines").found);
  ASSERT_TRUE(sut.lines.has_value());
  EXPECT_NEAR(sut.lines->repeats.rms, kNoise, 0.002);
}

// As without a period: none of ten recordings answers.
TEST(DetectionTest, NoiseOnAPeriodicExcitationAnswersNoQuestion) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto u = made::multisine(kCount, 1000, {5, 11, 15, 23, 31, 37, 45, 55}, 70 + seed);
    const auto noise = made::answer({1.0}, {1.0, -0.9}, made::white(kCount, 90 + seed));
    const auto y = made::mix({{1.0, made::answer(made::two_pole_body(), u)}, {kNoise, noise}});
    const DetectionResult sut = detected_in(made::measurement_of({{"u", "V", u}, {"y", "N", y}}));
    EXPECT_TRUE(sut.lines.has_value());
    expect_silent(sut, seed);
  }
}

bool moves_at(std::size_t n) { return n / 200 == 5 || n / 200 == 11 || n / 200 == 22; }

// The channel moves in three blocks of thirty, where the output follows it: no surrogate does.
TEST(DetectionTest, AChannelThatMovesInAFewBlocksIsFound) {
  Measurement measurement = made_with(50, [](auto...) { return 0.0; });
  std::vector<double>& v = measurement.channels[1].values;
  for (std::size_t n = 0; n < kCount; ++n) {
    if (!moves_at(n)) v[n] = 0.0;
    measurement.channels[2].values[n] += 0.07 * v[n];
  }
  const DetectionResult sut = detected_in(measurement);
  EXPECT_GT(asked(sut, "linear in", "v").share, 0.1);
  EXPECT_TRUE(asked(sut, "linear in", "v").found);
}

// The same channel next to noise that is loud in the same three blocks, and has nothing to do with
// it.
TEST(DetectionTest, NoiseThatIsLoudWhereAChannelMovesIsNotFound) {
  for (std::uint64_t seed = 51; seed < 56; ++seed) {
    Measurement measurement = made_with(seed, [](auto...) { return 0.0; });
    const std::vector<double> noise = made::ride(kCount, 1000 + seed);
    for (std::size_t n = 0; n < kCount; ++n) {
      measurement.channels[moves_at(n) ? 2 : 1].values[n] +=
          moves_at(n) ? 0.3 * noise[n] : -measurement.channels[1].values[n];
    }
    EXPECT_FALSE(asked(detected_in(measurement), "linear in", "v").found) << seed;
  }
}

// At one sample in two seconds, a second has no lag; one sample is looked at all the same.
TEST(DetectionTest, TheAutocorrelationOfSlowSamplesHasALag) {
  Measurement measurement = made_with(30, [](auto...) { return 0.0; });
  measurement.rate_hz = 0.5;
  const Whiteness sut = detected_in(measurement).whiteness;
  EXPECT_EQ(sut.autocorrelation.size(), 2u);
  EXPECT_TRUE(std::isfinite(sut.share_outside));
}

// Colour is reported, and is not an effect.
TEST(DetectionTest, ColouredNoiseIsNotWhiteAndNoEffect) {
  const auto colour = made::answer({1.0}, {1.0, -0.9}, made::white(kCount, 31));
  const DetectionResult sut =
      detected_in(made_with(30, [&](std::size_t n, auto...) { return 0.1 * colour[n]; }));
  EXPECT_GT(sut.whiteness.share_outside, 0.15);
  expect_silent(sut, 30);
  EXPECT_DOUBLE_EQ(sut.whiteness.autocorrelation.front(), 1.0);
  EXPECT_EQ(sut.whiteness.autocorrelation.size(), 101u) << "lags up to 1 s";
  // 0.9^5 = 0.59 of the coloured part, which holds 0.053 of 0.055 in power.
  EXPECT_NEAR(sut.whiteness.autocorrelation[5], 0.56, 0.1);
  EXPECT_NEAR(sut.whiteness.bound, 2.576 / std::sqrt(6000.0), 1e-6);
}

TEST(DetectionTest, SpreadTellsWhereTheResidualIsLarge) {
  const auto burst = made::white(kCount, 41);
  const DetectionResult sut = detected_in(made_with(
      40, [&](std::size_t n, auto...) { return n >= 3000 && n < 3200 ? 0.5 * burst[n] : 0.0; }));
  // 0.5 and 0.05 against 0.05 over one block of 200 samples, known to 5 %.
  EXPECT_NEAR(sut.spread.largest_ratio, std::hypot(0.5, 0.05) / 0.05, 1.5);
  const auto largest = std::ranges::max_element(sut.spread.rms);
  EXPECT_NEAR(sut.spread.time_s[static_cast<std::size_t>(largest - sut.spread.rms.begin())], 31.0,
              0.1);
}

// White noise: the middle 80 % of its power lie from 5 to 45 of 50 Hz, each known to 6 % of 5 Hz.
TEST(UnexplainedTest, TheStrongestAnswerTheBandTheTimesAndTheChannelsAreTold) {
  const made::Studied of(made_with(42, [](auto...) { return 0.0; }), 2);
  DetectionResult after;
  after.detections = {{"cube of", "x", 0.9, 1.0, false, {"x"}},
                      {"product of", "v and w", 0.234, 0.01, true, {"v", "w"}},
                      {"linear in", "v", 0.2, 0.01, true, {"v", "a", "b"}}};
  after.spread = {{1.0, 3.0, 5.0, 7.0, 9.0}, {0.1, 0.9, 0.2, 0.3, 0.4}, 3.0};
  const auto sut = unexplained_of(after, of.screening);
  ASSERT_TRUE(sut.has_value());
  EXPECT_THAT(sut->what, testing::HasSubstr("product of v and w (23 % of its power, held out)"));
  EXPECT_THAT(sut->channels, testing::ElementsAre("v", "w", "a"));
  EXPECT_THAT(sut->times_s, testing::ElementsAre(3.0, 7.0, 9.0));
  EXPECT_NEAR(sut->band_hz[0], 5.0, 0.9);
  EXPECT_NEAR(sut->band_hz[1], 45.0, 0.9);
}

}  // namespace stillhand::diagnosis::detection_test
