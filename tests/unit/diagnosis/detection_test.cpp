// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  const Body body = made::two_pole_body();
  auto y = made::answer(body, u);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += kNoise * noise[n] + more(n, y[n], v[n]);
  return made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"y", "N", y}});
}

DetectionResult detected_in(const Measurement& measurement) {
  const made::Studied studied(measurement, 2);
  return detected(studied.screening, periodic_excitation_of(studied.signals));
}

const Detection* find(const DetectionResult& result, const std::string& question,
                      const std::string& channel) {
  for (const Detection& each : result.detections) {
    if (each.question == question && each.channel == channel) return &each;
  }
  return nullptr;
}

// Nothing is added to noise of 0.05: none of some twenty questions answers with more than 6 % of
// the power and a p of 1 %.
TEST(DetectionTest, WhiteNoiseAnswersNoQuestion) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const DetectionResult sut = detected_in(made_with(seed, [](auto...) { return 0.0; }));
    EXPECT_GT(sut.detections.size(), 10u);
    for (const Detection& each : sut.detections) {
      EXPECT_FALSE(each.found) << seed << ": " << each.question << " " << each.channel;
    }
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
  };
  const Case cases[] = {
      {"linear in", "v", [](std::size_t, double, double v) { return 0.1 * v; }},
      {"square of", "v", [](std::size_t, double, double v) { return 0.1 * v * v; }},
      {"cube of", "v", [](std::size_t, double, double v) { return 0.05 * v * v * v; }},
      {"gain by", "v", [](std::size_t, double y, double v) { return 0.3 * v * y; }},
      {"square of", "the body's output", [](std::size_t, double y, double) { return 0.2 * y * y; }},
      {"cube of", "the body's output",
       [](std::size_t, double y, double) { return 0.1 * y * y * y; }},
      {"gain over", "time",
       [](std::size_t n, double y, double) {
         return 0.3 * y * std::cos(std::numbers::pi * static_cast<double>(n) / kCount);
       }},
  };
  for (const Case& each : cases) {
    SCOPED_TRACE(std::string(each.question) + " " + each.channel);
    const DetectionResult sut = detected_in(made_with(20, each.more));
    const Detection* found = find(sut, each.question, each.channel);
    ASSERT_NE(found, nullptr);
    EXPECT_TRUE(found->found);
    EXPECT_GT(found->share, 0.3);
    EXPECT_EQ(found->p, kSignificance) << "none of the surrogates";
    // Strongest first.
    EXPECT_TRUE(std::ranges::is_sorted(sut.detections, std::ranges::greater(), &Detection::share));
  }
}

TEST(DetectionTest, AProductOfTwoChannelsIsAskedForAllPairs) {
  const auto u = made::ride(kCount, 1);
  const auto v = made::ride(kCount, 2);
  const auto w = made::ride(kCount, 3);
  const auto noise = made::white(kCount, 4);
  const Body body = made::two_pole_body();
  auto y = made::answer(body, u);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.2 * v[n] * w[n] + kNoise * noise[n];
  const DetectionResult sut = detected_in(
      made::measurement_of({{"u", "V", u}, {"v", "V", v}, {"w", "V", w}, {"y", "N", y}}));
  ASSERT_NE(find(sut, "product of", "v and w"), nullptr);
  EXPECT_TRUE(find(sut, "product of", "v and w")->found);
  EXPECT_EQ(sut.detections.front().channel, "v and w");
  EXPECT_EQ(sut.detections.front().channels, (std::vector<std::string>{"v", "w"}));
  ASSERT_NE(find(sut, "product of", "u and v"), nullptr);
  EXPECT_FALSE(find(sut, "product of", "u and v")->found);
}

// A square of what the input was over a second ago: no column is that, but the lines are.
TEST(DetectionTest, DistortionThatNoColumnShowsIsFoundAtTheLines) {
  const auto u = made::multisine(kCount, 1000, {5, 11, 15, 23, 31, 37, 45, 55}, 60);
  const auto noise = made::white(kCount, 61);
  const Body body = made::two_pole_body();
  auto y = made::answer(body, u);
  for (std::size_t n = 0; n < kCount; ++n) {
    y[n] += kNoise * noise[n] + (n < 125 ? 0.0 : 0.1 * u[n - 75] * u[n - 125]);
  }
  const DetectionResult sut = detected_in(made::measurement_of({{"u", "V", u}, {"y", "N", y}}));
  const Detection* even = find(sut, kDistortion, "even lines");
  ASSERT_NE(even, nullptr);
  EXPECT_TRUE(even->found);
  EXPECT_TRUE(even->channels.empty());
  const Detection* odd = find(sut, kDistortion, "odd lines");
  ASSERT_NE(odd, nullptr);
  EXPECT_FALSE(odd->found);
  ASSERT_TRUE(sut.lines.has_value());
  EXPECT_NEAR(sut.lines->repeats.rms, kNoise, 0.002);
}

// As without a period: none of ten recordings answers.
TEST(DetectionTest, NoiseOnAPeriodicExcitationAnswersNoQuestion) {
  const Body body = made::two_pole_body();
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto u = made::multisine(kCount, 1000, {5, 11, 15, 23, 31, 37, 45, 55}, 70 + seed);
    const auto noise = made::answer({1.0}, {1.0, -0.9}, made::white(kCount, 90 + seed));
    auto y = made::answer(body, u);
    for (std::size_t n = 0; n < kCount; ++n) y[n] += kNoise * noise[n];
    const DetectionResult sut = detected_in(made::measurement_of({{"u", "V", u}, {"y", "N", y}}));
    EXPECT_TRUE(sut.lines.has_value());
    for (const Detection& each : sut.detections) {
      EXPECT_FALSE(each.found) << seed << ": " << each.question << " " << each.channel;
    }
  }
}

// The channel moves in three blocks of thirty, where the output follows it: no surrogate does.
TEST(DetectionTest, AChannelThatMovesInAFewBlocksIsFound) {
  Measurement measurement = made_with(50, [](auto...) { return 0.0; });
  std::vector<double>& v = measurement.channels[1].values;
  std::vector<double>& y = measurement.channels[2].values;
  for (std::size_t n = 0; n < kCount; ++n) {
    const std::size_t block = n / 200;
    if (block != 5 && block != 11 && block != 22) v[n] = 0.0;
    y[n] += 0.07 * v[n];
  }
  const DetectionResult sut = detected_in(measurement);
  const Detection* asked = find(sut, "linear in", "v");
  ASSERT_NE(asked, nullptr);
  EXPECT_GT(asked->share, 0.1);
  EXPECT_TRUE(asked->found);
}

// The same channel next to noise that is loud in the same three blocks, and has nothing to do with
// it.
TEST(DetectionTest, NoiseThatIsLoudWhereAChannelMovesIsNotFound) {
  for (std::uint64_t seed = 51; seed < 56; ++seed) {
    Measurement measurement = made_with(seed, [](auto...) { return 0.0; });
    const std::vector<double> noise = made::ride(kCount, 1000 + seed);
    for (std::size_t n = 0; n < kCount; ++n) {
      const std::size_t block = n / 200;
      const bool loud = block == 5 || block == 11 || block == 22;
      if (!loud) measurement.channels[1].values[n] = 0.0;
      measurement.channels[2].values[n] += loud ? 0.3 * noise[n] : 0.0;
    }
    const Detection* asked = find(detected_in(measurement), "linear in", "v");
    ASSERT_NE(asked, nullptr);
    EXPECT_FALSE(asked->found) << seed;
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
  for (const Detection& each : sut.detections) {
    EXPECT_FALSE(each.found) << each.question << " " << each.channel;
  }
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
  // 0.5 against 0.05 over one block of 200 samples.
  EXPECT_GT(sut.spread.largest_ratio, 7.0);
  const auto largest = std::ranges::max_element(sut.spread.rms);
  EXPECT_NEAR(sut.spread.time_s[static_cast<std::size_t>(largest - sut.spread.rms.begin())], 31.0,
              0.1);
}

}  // namespace stillhand::diagnosis::detection_test
