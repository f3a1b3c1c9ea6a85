// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/diagnosis/proposed.hpp"

// Effects that hang on a channel besides the input, each on a recording of its own, beyond what
// tried_values_test.cpp has.
namespace stillhand::diagnosis::effects_of_channels_test {

using made::expect_proposed;
using made::Planted;

constexpr std::size_t kCount = 6000;
const std::vector<double> kU = made::ride(kCount, 1);
const std::vector<double> kV = made::ride(kCount, 2);
// A stick that wanders.
const std::vector<double> kTheta = made::ride(kCount, 3, 0.05, 1.0);
const Body kBody = made::two_pole_body();

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

// METHOD "Kinds": both signs for 2 % of the time.
TEST(EffectsOfChannelsTest, ARateThatHardlyTurnsHasNoFrictionToShow) {
  for (const auto& [percent, shown] : {std::pair{1, false}, {3, true}, {97, true}, {99, false}}) {
    std::vector<double> belt(kCount);
    for (std::size_t n = 0; n < kCount; ++n) {
      belt[n] = static_cast<int>(n % 100) < percent ? -1.0 : 1.0;
    }
    const made::Studied of(planted("", "", kV, {{"v", "m/s", belt}}, {}).measurement, 0);
    EXPECT_EQ(effect_kind("coulomb_friction").proposed(of.screening).empty(), !shown) << percent;
  }
}

// 30 periods a turn.
TEST(EffectsOfChannelsTest, ARippleOfTwoHarmonics) {
  const double per_rad = 30.0 / (2.0 * std::numbers::pi);
  const auto ripple = [&](std::size_t n, int harmonic) {
    return std::sin(2.0 * std::numbers::pi * harmonic * per_rad * kTheta[n] + 0.5);
  };
  const double range = 6.0;  // [rad] of the angle, about: lines are 1/range wide
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

}  // namespace stillhand::diagnosis::effects_of_channels_test
