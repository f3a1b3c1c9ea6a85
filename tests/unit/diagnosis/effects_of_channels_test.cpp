// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/proposed.hpp"

// Effects that hang on a channel besides the input.  Each on a recording of its own.
namespace stillhand::diagnosis::effects_of_channels_test {

using made::expect_proposed;
using made::Planted;

constexpr std::size_t kCount = 6000;
const std::vector<double> kU = made::ride(kCount, 1);
const std::vector<double> kV = made::ride(kCount, 2);
// A stick that wanders: angle and its exact rate by central differences.
const std::vector<double> kTheta = made::ride(kCount, 3, 0.05, 1.0);
const Body kBody = made::two_pole_body();

std::vector<double> rate_of(const std::vector<double>& x) {
  std::vector<double> rate(x.size(), 0.0);
  for (std::size_t n = 1; n + 1 < x.size(); ++n) rate[n] = 50.0 * (x[n + 1] - x[n - 1]);
  return rate;
}

// Body on u plus something more at every sample.
std::vector<double> answer_and(const std::function<double(std::size_t)>& more) {
  auto y = made::answer(kBody, kU);
  for (std::size_t n = 0; n < kCount; ++n) y[n] += more(n);
  return y;
}

Planted planted(const char* kind, const char* form, const std::vector<double>& y,
                std::vector<Channel> others, std::vector<std::string> channels) {
  return made::planted_in(kind, form, y, kU, std::move(channels), std::move(others));
}

TEST(EffectsOfChannelsTest, AStaticPathFromAnotherChannel) {
  expect_proposed(
      planted("coupled_input", "static", answer_and([](std::size_t n) { return 0.2 * kV[n]; }),
              {{"a_x", "m/s^2", kV}, {"temp", "degC", made::ride(kCount, 9)}}, {"a_x"}));
}

TEST(EffectsOfChannelsTest, APathThatLags) {
  const double keep = std::exp(-0.01 / 0.15);
  const auto slow = made::answer({1.0 - keep}, {1.0, -keep}, kV);
  // Lags of 0.05, 0.2 and 0.8 s are tried.
  expect_proposed(
      planted("coupled_input", "lagged", answer_and([&](std::size_t n) { return 0.5 * slow[n]; }),
              {{"roll", "rad", kV}}, {"roll"}),
      {{0, 0.15, 0.051, 0.005}});
}

TEST(EffectsOfChannelsTest, APathThroughTheBody) {
  const auto passed = made::answer({0.3, -0.1, 0.1}, kBody.denominator, kV);
  expect_proposed(planted("coupled_input", "through the body",
                          answer_and([&](std::size_t n) { return 0.5 * passed[n]; }),
                          {{"a_x", "V", kV}}, {"a_x"}));
}

TEST(EffectsOfChannelsTest, AStickThatPullsWithAngleAndRate) {
  const auto omega = rate_of(kTheta);
  expect_proposed(
      planted("coupled_input", "static with rate",
              answer_and([&](std::size_t n) { return 0.2 * kTheta[n] + 0.1 * omega[n]; }),
              {{"theta", "rad", kTheta}, {"omega", "rad/s", omega}}, {"theta", "omega"}));
}

TEST(EffectsOfChannelsTest, FrictionWithTheSignOfARate) {
  const auto omega = rate_of(kTheta);
  const auto y = answer_and([&](std::size_t n) { return omega[n] > 0.0 ? -0.2 : 0.2; });
  Planted measured = planted("coulomb_friction", "sign, beside the body", y,
                             {{"omega", "rad/s", omega}}, {"omega"});
  // The sign at the sample itself was planted, its mean over half a sample on each side is fitted:
  // half a jump of 0.4 is off at each of the crossings, some 2 a second.
  measured.left = 3.0;
  expect_proposed(measured);
  // The rate implied by a position does as well.
  Planted implied = planted("coulomb_friction", "sign, beside the body", y,
                            {{"theta", "rad", kTheta}}, {"rate of theta"});
  implied.left = 3.0;
  expect_proposed(implied);
}

// Rates of -1, 1, 1, -3, 0, 0, 0 on straight lines: half a sample on each side of the third it is
// positive up to 0, then negative for as long; the first has one side, and rest has no sign.
TEST(EffectsOfChannelsTest, TheSignOfARateIsItsMeanAroundTheSample) {
  const auto x = made::white(7, 1);
  const Signals signals(
      made::measurement_of(
          {{"u", "V", x}, {"v", "rad/s", {-1.0, 1.0, 1.0, -3.0, 0.0, 0.0, 0.0}}, {"y", "N", x}}),
      {"u"}, "y");
  Columns sut;
  effect_kind("coulomb_friction")
      .terms({"coulomb_friction", "sign, beside the body", {"v"}, {}, {1.0}}, signals, {}, sut);
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_EQ(sut[0], (std::vector<double>{-1.0, 1.0, 0.5, -1.0, -0.5, 0.0, 0.0}));
}

TEST(EffectsOfChannelsTest, FrictionThatSetsInSmoothly) {
  const auto omega = rate_of(kTheta);
  const double transition = 0.3 * made::rms_of(omega);
  expect_proposed(
      planted("coulomb_friction", "smooth sign, beside the body",
              answer_and([&](std::size_t n) { return -0.2 * std::tanh(omega[n] / transition); }),
              {{"omega", "rad/s", omega}}, {"omega"}),
      {{0, transition, 0.51 * transition, 0.03 * transition}});
}

TEST(EffectsOfChannelsTest, ARateThatNeverTurnsHasNoFrictionToShow) {
  std::vector<double> belt = kV;
  for (double& v : belt) v = 20.0 + v;
  const made::Studied of(
      planted("", "", answer_and([](std::size_t) { return 0.3; }), {{"v", "m/s", belt}}, {})
          .measurement,
      2);
  EXPECT_TRUE(effect_kind("coulomb_friction").proposed(of.screening).empty());
}

// 30 periods a turn.
TEST(EffectsOfChannelsTest, ARippleOverAPosition) {
  const double per_rad = 30.0 / (2.0 * std::numbers::pi);
  const auto ripple = [&](std::size_t n, int harmonic) {
    return std::sin(2.0 * std::numbers::pi * harmonic * per_rad * kTheta[n] + 0.5);
  };
  const double range = 6.0;  // [rad] of the angle, about: lines are 1/range wide
  expect_proposed(planted("position_ripple", "one harmonic",
                          answer_and([&](std::size_t n) { return 0.2 * ripple(n, 1); }),
                          {{"theta", "rad", kTheta}}, {"theta"}),
                  {{0, per_rad, 0.5 / range, 0.002}});
  expect_proposed(planted("position_ripple", "two harmonics", answer_and([&](std::size_t n) {
                            return 0.2 * ripple(n, 1) + 0.1 * ripple(n, 2);
                          }),
                          {{"theta", "rad", kTheta}}, {"theta"}),
                  {{0, per_rad, 0.5 / range, 0.002}});
}

// The model has a ripple with two harmonics; a line at either must not be proposed again.  Lines
// are 1/range wide, and the angle's range is some 6 rad.
TEST(EffectsOfChannelsTest, ARippleThatSharesAHarmonicIsNotProposedAgain) {
  const double per_rad = 30.0 / (2.0 * std::numbers::pi);
  const auto ripple = [&](std::size_t n, int harmonic) {
    return std::sin(2.0 * std::numbers::pi * harmonic * per_rad * kTheta[n]);
  };
  const made::Studied of(
      planted("", "", answer_and([&](std::size_t n) { return ripple(n, 1) + ripple(n, 2); }),
              {{"theta", "rad", kTheta}}, {})
          .measurement,
      2);
  const EffectKind& sut = effect_kind("position_ripple");
  ASSERT_FALSE(sut.proposed(of.screening).empty());
  Model model = of.baseline.model;
  model.effects.push_back(made::effect_of(
      "position_ripple", "two harmonics", {"theta"},
      {{"spatial_frequency", "1/rad", per_rad, per_rad, per_rad}}, {0.0, 0.0, 0.0, 0.0}));
  const Screening again(model, of.signals, of.blocks, of.impulse_response);
  for (const Proposal& proposal : sut.proposed(again)) {
    const double frequency = proposal.effect.value(0);
    EXPECT_GT(std::abs(frequency - per_rad), 1.0 / 6.0) << "1/rad";
    EXPECT_GT(std::abs(frequency - 2.0 * per_rad), 1.0 / 6.0) << "1/rad";
  }
}

TEST(EffectsOfChannelsTest, AProductOfTwoChannels) {
  const auto w = made::ride(kCount, 5);
  expect_proposed(planted("bilinear", "beside the body",
                          answer_and([&](std::size_t n) { return 0.15 * kV[n] * w[n]; }),
                          {{"roll", "V", kV}, {"a_x", "V", w}}, {"roll", "a_x"}));
  std::vector<double> product(kCount);
  for (std::size_t n = 0; n < kCount; ++n) product[n] = kV[n] * kU[n];
  const auto passed = made::answer({0.3, -0.1, 0.1}, kBody.denominator, product);
  expect_proposed(planted("bilinear", "through the body",
                          answer_and([&](std::size_t n) { return 0.3 * passed[n]; }),
                          {{"grip", "V", kV}}, {"u", "grip"}));
}

TEST(EffectsOfChannelsTest, AGainThatFollowsAChannel) {
  const auto slow = made::ride(kCount, 6, 0.05, 0.3);
  auto y = made::answer(kBody, kU);
  for (std::size_t n = 0; n < kCount; ++n) y[n] *= 1.0 + 0.2 * slow[n];
  // The centre is the channel's mean, about which the gain is 1.
  expect_proposed(planted("bilinear", "gain of the body", y, {{"grip", "N", slow}}, {"grip"}),
                  {{0, 0.2, 0.02, 0.004}});
}

TEST(EffectsOfChannelsTest, AnEvenPartInAChannel) {
  expect_proposed(planted("asymmetry", "square, beside the body",
                          answer_and([](std::size_t n) { return 0.1 * kV[n] * kV[n]; }),
                          {{"a_x", "V", kV}}, {"a_x"}));
}

TEST(EffectsOfChannelsTest, ACubicSpringOnAPosition) {
  expect_proposed(
      planted("nonlinear_stiffness", "cubic, beside the body",
              answer_and([](std::size_t n) { return 0.05 * kTheta[n] * kTheta[n] * kTheta[n]; }),
              {{"theta", "rad", kTheta}}, {"theta"}));
}

TEST(EffectsOfChannelsTest, PlayInAPosition) {
  Planted sut = planted("dead_zone", "beside the body", answer_and([](std::size_t n) {
                          return 0.5 * (kTheta[n] - std::clamp(kTheta[n], -0.5, 0.5));
                        }),
                        {{"theta", "rad", kTheta}}, {"theta"});
  // Half-widths of 0.4 and 0.8 standard deviations are tried on either side.
  expect_proposed(sut, {{0, 0.5, 0.31, 0.02}});
}

// w follows theta/0.4 and yields at +-1.
TEST(EffectsOfChannelsTest, HysteresisOfAPosition) {
  std::vector<double> w(kCount, 0.0);
  std::vector<double> dahl(kCount, 0.0);
  for (std::size_t n = 1; n < kCount; ++n) {
    const double dz = (kTheta[n] - kTheta[n - 1]) / 0.4;
    w[n] = std::clamp(w[n - 1] + dz, -1.0, 1.0);
    // dw = dz (1 - w sign dz), exactly over a step in one direction.
    const double towards = dz >= 0.0 ? 1.0 : -1.0;
    dahl[n] = towards + (dahl[n - 1] - towards) * std::exp(-std::abs(dz));
  }
  // 0.2, 0.5 and 1 standard deviations are tried.
  expect_proposed(planted("hysteresis", "elastic-plastic, beside the body",
                          answer_and([&](std::size_t n) { return 0.3 * w[n]; }),
                          {{"theta", "rad", kTheta}}, {"theta"}),
                  {{0, 0.4, 0.21, 0.02}});
  expect_proposed(planted("hysteresis", "smooth, beside the body",
                          answer_and([&](std::size_t n) { return 0.3 * dahl[n]; }),
                          {{"theta", "rad", kTheta}}, {"theta"}),
                  {{0, 0.4, 0.21, 0.02}});
}

}  // namespace stillhand::diagnosis::effects_of_channels_test
