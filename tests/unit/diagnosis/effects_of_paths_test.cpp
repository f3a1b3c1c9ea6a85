// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

// 800 us/s over 60 s: 24 ms each way; the reference time is the middle of the record.
TEST(EffectsOfPathsTest, ClocksThatRunApart) {
  for (const double drift_us_s : {800.0, -300.0}) {
    Planted sut = planted("clock_drift", "of the output", answer(sampled([&](double t_s) {
                            return many_sines(t_s - 1e-6 * drift_us_s * (t_s - 29.995));
                          })),
                          sampled(many_sines));
    // 500 and 1000 us/s are tried on both sides, and none.
    expect_proposed(sut, {{0, drift_us_s, 250.0, 3.0}, {1, 29.995, 1e-9, 1e-9}});
  }
}

TEST(EffectsOfPathsTest, AModeBeyondTheBodysOrder) {
  auto y = answer(kU);
  const auto ringing = made::answer({0.2, -0.1}, made::mode(6.0, 0.05), kU);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += 0.3 * ringing[n];
  // 24 frequencies from 0.3 to 40 Hz, a factor of 1.24 apart; dampings 0.03, 0.1, 0.3.
  expect_proposed(planted("resonance", "beside the body", y),
                  {{0, 6.0, 0.8, 0.02}, {1, 0.05, 0.051, 0.003}});
}

// The standard deviation is 1: limits of 0.3 to 2.5 are tried.
TEST(EffectsOfPathsTest, AnInputThatIsLimited) {
  expect_proposed(
      planted("input_saturation", "hard",
              answer(mapped(kU, [](double u) { return std::clamp(u, -1.0, 1.0); })), kU, {"u"}),
      {{0, 1.0, 0.3, 0.01}});
}

TEST(EffectsOfPathsTest, AnInputThatBends) {
  Planted soft =
      planted("input_saturation", "",
              answer(mapped(kU, [](double u) { return 1.2 * std::tanh(u / 1.2); })), kU, {"u"});
  // Either form may screen better; the search distinguishes them by the residual.
  soft.left = 20.0;
  expect_proposed(soft);
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

TEST(EffectsOfPathsTest, PlayAtTheInputAndAtTheOutput) {
  expect_proposed(
      planted("dead_zone", "at the input",
              answer(mapped(kU, [](double u) { return u - std::clamp(u, -0.3, 0.3); })), kU, {"u"}),
      {{0, 0.3, 0.15, 0.01}});
  const auto y = answer(kU);
  const double width = 0.4 * made::rms_of(y);
  std::vector<double> lost = y;
  for (double& value : lost) value -= std::clamp(value, -width, width);
  expect_proposed(planted("dead_zone", "at the output", lost),
                  {{0, width, 0.3 * width, 0.03 * width}});
}

TEST(EffectsOfPathsTest, SlopesThatDifferWithTheSign) {
  expect_proposed(
      planted("asymmetry", "slopes at the input",
              answer(mapped(kU, [](double u) { return u + 0.15 * std::abs(u); })), kU, {"u"}),
      {{0, 0.15, 0.02, 0.005}});
  std::vector<double> y = answer(kU);
  for (double& value : y) value += 0.15 * std::abs(value);
  expect_proposed(planted("asymmetry", "slopes at the output", y), {{0, 0.15, 0.02, 0.005}});
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

TEST(EffectsOfPathsTest, AnOutputThatHardens) {
  std::vector<double> y = answer(kU);
  const double kappa = 0.03 / std::pow(made::rms_of(y), 2);
  for (double& value : y) value += kappa * value * value * value;
  expect_proposed(planted("nonlinear_stiffness", "at the output", y),
                  {{0, kappa, 0.5 * kappa, 0.03 * kappa}});
}

}  // namespace stillhand::diagnosis::effects_of_paths_test
