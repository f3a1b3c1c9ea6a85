// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/fitting/lost_sign.hpp"
#include "tests/unit/diagnosis/proposed.hpp"

// Effects between input and output: time, maps, modes.  Each on a recording of its own.
namespace stillhand::diagnosis::effects_of_paths_test {

using made::expect_proposed;
using made::Planted;
using made::Studied;

constexpr std::size_t kCount = 6000;
const std::vector<double> kU = made::ride(kCount, 1);
const Body kBody = made::two_pole_body();

std::vector<double> answer(const std::vector<double>& u) { return made::answer(kBody, u); }

std::vector<double> mapped(std::vector<double> x, double (*map)(double)) {
  for (double& value : x) value = map(value);
  return x;
}

// 24 sines, so that the input is known between its samples.
double many_sines(double t_s) {
  double sum = 0.0;
  for (int k = 0; k < 24; ++k) {
    const double frequency_hz = 0.61 + 0.283 * k;
    sum += std::sin(2.0 * std::numbers::pi * frequency_hz * t_s + 1.7 * k * k);
  }
  return sum / std::sqrt(12.0);
}

std::vector<double> sampled(const std::function<double(double)>& at) {
  std::vector<double> x(kCount);
  for (std::size_t n = 0; n < kCount; ++n) x[n] = at(static_cast<double>(n) / made::kRateHz);
  return x;
}

Planted planted(const char* kind, const char* form, const std::vector<double>& y,
                const std::vector<double>& u = kU, std::vector<std::string> channels = {}) {
  return made::planted_in(kind, form, y, u, std::move(channels));
}

// The zeros of a four-pole body can absorb a sample or two of 10 ms of it, and the error then has
// minima as deep next to the true one: 15 ms.  A second check: nothing but the noise is left.
TEST(EffectsOfPathsTest, ADelay) {
  const Body body = made::four_pole_body();
  const auto late = sampled([](double t_s) { return many_sines(t_s - 0.1134); });
  Planted sut = planted("delay", "of the input", made::answer(body, late), sampled(many_sines));
  sut.order = 4;
  expect_proposed(sut, {{0, 0.1134, 0.015, 0.015}});
}

TEST(EffectsOfPathsTest, AModeBeyondTheBodysOrder) {
  auto y = answer(kU);
  const auto ringing = made::answer({0.2, -0.1}, made::mode(6.0, 0.05), kU);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.3 * ringing[n];
  // 24 frequencies from 0.3 to 40 Hz, a factor of 1.24 apart; dampings 0.03, 0.1, 0.3.
  expect_proposed(planted("resonance", "beside the body", y),
                  {{0, 6.0, 0.8, 0.02}, {1, 0.05, 0.051, 0.003}});
}

TEST(EffectsOfPathsTest, AnOutputThatIsLimited) {
  const auto y = answer(kU);
  const double limit = 1.2 * made::rms_of(y);
  std::vector<double> clipped = y;
  for (double& value : clipped) value = std::clamp(value, -limit, limit);
  expect_proposed(planted("output_saturation", "hard", clipped),
                  {{0, limit, 0.1 * limit, 0.01 * limit}});
}

TEST(EffectsOfPathsTest, AnOutputThatEndsEarlierOnOneSide) {
  const auto y = answer(kU);
  const double up = 1.6 * made::rms_of(y);
  const double down = -1.0 * made::rms_of(y);
  std::vector<double> clipped = y;
  for (double& value : clipped) value = std::clamp(value, down, up);
  expect_proposed(planted("output_saturation", "hard, two limits", clipped),
                  {{0, up, 0.1 * up, 0.01 * up}, {1, down, -0.1 * down, -0.01 * down}});
}

TEST(EffectsOfPathsTest, AnOutputThatBends) {
  const auto y = answer(kU);
  const double limit = 2.0 * made::rms_of(y);
  std::vector<double> bent = y;
  for (double& value : bent) value = limit * std::tanh(value / limit);
  expect_proposed(planted("output_saturation", "soft", bent),
                  {{0, limit, 0.3 * limit, 0.02 * limit}});
}

TEST(EffectsOfPathsTest, PlayAtTheOutput) {
  const auto y = answer(kU);
  const double width = 0.4 * made::rms_of(y);
  std::vector<double> lost = y;
  for (double& value : lost) value -= std::clamp(value, -width, width);
  expect_proposed(planted("dead_zone", "at the output", lost),
                  {{0, width, 0.3 * width, 0.03 * width}});
}

// A heater: its power goes with the square of the voltage.  An input of both signs: the linear body
// explains nothing of it.
TEST(EffectsOfPathsTest, AnInputThatActsByItsSquare) {
  for (const double level : {4.0, 0.0}) {
    std::vector<double> u = kU;
    for (double& value : u) value += level;
    double largest = 0.0;
    for (const double value : u) largest = std::max(largest, std::abs(value));
    expect_proposed(planted("asymmetry", "square at the input",
                            answer(mapped(u, [](double x) { return x * x; })), u, {"u"}),
                    {{0, 1.0, 0.61, 0.005}, {1, largest, 1e-12, 1e-12}});
  }
}

// The linear body explains next to nothing of it; the offset is the sensor's.
TEST(EffectsOfPathsTest, AnOutputThatIsASize) {
  const double offset = 0.3 * made::rms_of(answer(kU));
  std::vector<double> y = answer(kU);
  for (double& value : y) value = std::abs(value + offset);
  const Planted sut = planted("asymmetry", "size at the output", y);
  expect_proposed(sut);
  const Studied of(sut.measurement, 2);
  EXPECT_GT(of.baseline.rmse, 0.9 * of.signals.output().deviation);
  // All signs or all the others: the noise of 1 % turns some about 0, of 6000.
  const std::vector<double> found = with_lost_sign(of.signals);
  std::size_t alike = 0;
  const std::vector<double> truth = answer(kU);
  for (std::size_t n = 0; n < kCount; ++n) alike += found[n] * (truth[n] + offset) > 0.0 ? 1u : 0u;
  EXPECT_LT(std::min(alike, kCount - alike), 150u);
}

// Noise about zero is no sign: of a size as much as 1 % of the samples may be 5 % of the deviation
// below zero.  Of the bodies of four orders the two best are tried.
TEST(EffectsOfPathsTest, AnOutputWithMoreThanNoiseBelowZeroIsNoSize) {
  const auto proposed = [](double below) {
    std::vector<double> y = answer(kU);
    for (double& value : y) value = std::abs(value);
    std::vector<double> sorted = y;
    std::ranges::sort(sorted);
    const double deviation = std::sqrt(signal::variance(y));
    for (double& value : y) value -= sorted[(kCount - 1) / 100] + below * deviation;
    const Studied of(made::measurement_of({{"u", "V", kU}, {"y", "N", y}}), 2);
    return std::ranges::count_if(
        effect_kind("asymmetry").proposed(of.screening),
        [](const Proposal& each) { return each.effect.form == "size at the output"; });
  };
  EXPECT_EQ(proposed(0.049), 2);
  EXPECT_EQ(proposed(0.051), 0);
}

// Of an output that is 0.4 to 0.6 N the lower of two limits would be none.
TEST(EffectsOfPathsTest, AnOutputOfOneSignHasNoTwoLimits) {
  const auto proposes_two = [](double level, double swing) {
    std::vector<double> y = answer(kU);
    const double largest =
        std::abs(*std::ranges::max_element(y, {}, [](double value) { return std::abs(value); }));
    for (double& value : y) value = level + swing * value / largest;
    const Planted sut = planted("output_saturation", "hard", y);
    const Studied of(sut.measurement, 2);
    return std::ranges::any_of(
        effect_kind("output_saturation").proposed(of.screening),
        [](const Proposal& each) { return each.effect.form == "hard, two limits"; });
  };
  EXPECT_FALSE(proposes_two(0.5, 0.1));
  EXPECT_TRUE(proposes_two(0.0, 0.1));
}

}  // namespace stillhand::diagnosis::effects_of_paths_test
