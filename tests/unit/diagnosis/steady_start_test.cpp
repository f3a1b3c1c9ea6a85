// SPDX-License-Identifier: Apache-2.0
// Every path with a memory starts where its first second would have brought it, Eq. DG-54.
#include "services/core/diagnosis/model/steady_start.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::steady_start_test {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Pointwise;

constexpr std::size_t kCount = 2001;
constexpr std::size_t kCut = 1200;

// A temperature of 23 degrees, a vertical acceleration with gravity in it, and a ride.
Signals signals_of(const std::vector<double>& u, const std::vector<double>& v) {
  Measurement measurement =
      made::measurement_of({{"u", "V", u}, {"v", "degC", v}, {"y", "N", made::white(kCount, 9)}});
  return {made::cut_in_two(std::move(measurement), kCut, 5.0), {"u"}, "y"};
}

std::vector<double> constant(double level) { return std::vector<double>(kCount, level); }

// Constant but for the last sample: a channel that never moves is left out of the signals.
std::vector<double> nearly_constant(double level) {
  std::vector<double> x = constant(level);
  x.back() += 1.0;
  return x;
}

std::vector<double> but_the_last(std::vector<double> x) {
  x.pop_back();
  return x;
}

// The first second at 25 without a swing; then one between -1 and 1, about 0 but for a hundredth.
TEST(SteadyStartTest, TheLevelIsTheFirstSecondsMeanAndNoneOfItsSwing) {
  std::vector<double> x = constant(20.0);
  for (std::size_t n = 0; n <= 100; ++n) x[n] = 25.0;  // sample 100, at 1.00 s, is the last
  for (std::size_t n = kCut; n < kCount; ++n) x[n] = n % 2 == 0 ? 1.0 : -1.0;
  const std::vector<double> sut = start_levels(x, signals_of(x, x));
  EXPECT_NEAR(sut[0], 25.0, 1e-9);
  EXPECT_EQ(sut[1], 0.0);
}

// Between 0 and 2 m: m as large as the swing counts nothing; 1.5 times, (2.25 - 1)/3; twice, whole.
TEST(SteadyStartTest, BetweenOneAndTwoSwingsTheMeanCountsInPart) {
  std::vector<double> x(kCount);
  const auto level_at = [&](double mean) {
    for (std::size_t n = 0; n < kCount; ++n) x[n] = mean + (n % 2 == 0 ? 1.0 : -1.0);
    x[100] = mean;
    return start_levels(x, signals_of(x, x))[0];
  };
  const double square = 100.0 / 101.0;
  EXPECT_EQ(level_at(0.99), 0.0);
  EXPECT_NEAR(level_at(1.5), 1.5 * (2.25 - square) / (3.0 * square), 1e-12);
  EXPECT_NEAR(level_at(2.0), 2.0, 1e-12);
}

TEST(SteadyStartTest, APathThatHasSettledStaysSettled) {
  const std::vector<double> a = made::four_pole_body().denominator;
  double at_rest = 0.0;
  for (const double c : a) at_rest += c;
  const Signals signals = signals_of(nearly_constant(9.81), constant(0.0));
  const auto& stretches = signals.stretches();
  const Settled sut = through_poles(settled(constant(9.81), signals), a, stretches);
  EXPECT_THAT(sut.values, Each(DoubleNear(9.81 / at_rest, 1e-8)));
  EXPECT_THAT(sut.before, Each(DoubleNear(9.81 / at_rest, 1e-8)));
  EXPECT_THAT(differenced(sut, stretches).values, Each(DoubleNear(0.0, 1e-8)));
  EXPECT_THAT(late(sut, stretches).values, Each(DoubleNear(9.81 / at_rest, 1e-8)));
}

TEST(SteadyStartTest, WithoutALevelItIsTheRecursionFromRest) {
  std::vector<double> x = made::white(kCount, 3);
  const Settled at_rest{x, {0.0, 0.0}};
  const std::vector<double> a = made::four_pole_body().denominator;
  const std::vector<Stretch> stretches{{0, kCut, 0.0}, {kCut, kCount, 30.0}};
  EXPECT_EQ(through_poles(at_rest, a, stretches).values, through_poles(x, a, stretches));
  EXPECT_EQ(differenced(at_rest, stretches).values, differenced(x, stretches));
}

// What is left of an offset: the offset.  From rest the first would swing over the body's memory,
// the slow path would rise over 3 s, and the spring would start from where it never was.
TEST(SteadyStartTest, AnOffsetMakesNoTransient) {
  const Effect through{
      "coupled_input", "through the body", {"v"}, {}, {0.02, 0.1, -0.2, 0.1, 0.05}};
  const Effect slow{"coupled_input", "lagged", {"v"}, {{"lag", "s", 3.0, 0.1, 9.0}}, {4.0}};
  const Effect mode = made::effect_of(
      "resonance", "beside the body", {},
      {{"frequency", "Hz", 0.5, 0.1, 40.0}, {"damping_ratio", "-", 0.05, 0.003, 0.9}},
      {0.2, 0.001});
  const Effect spring =
      made::effect_of("nonlinear_stiffness", "bent of the output", {},
                      {{"threshold", "N", 2.0, 0.1, 9.0}}, {-0.001, 0.003, 0.01, 0.02});
  const Effect play =
      made::effect_of("hysteresis", "elastic-plastic of the output", {},
                      {{"threshold", "N", 2.0, 0.1, 9.0}}, {-0.001, 0.003, 0.01, 0.02});
  const Signals signals = signals_of(nearly_constant(9.81), nearly_constant(23.0));
  for (const std::vector<Effect>& effects : std::vector<std::vector<Effect>>{
           {}, {through}, {slow}, {mode}, {spring}, {play}, {spring, through}}) {
    SCOPED_TRACE(effects.empty() ? "the body" : effects.front().kind + effects.front().form);
    const FreeRun run = free_run(made::model_of(made::four_pole_body(), effects), signals);
    ASSERT_TRUE(run.finite);
    const std::vector<double> sut = but_the_last(run.prediction);
    ASSERT_GT(std::abs(sut.front()), 1.0) << "the offset passes";
    // Poles near 1 and the spring's own steady state: rounding a few hundred times 31 N.
    EXPECT_THAT(sut, Each(DoubleNear(sut.front(), 1e-7)));
  }
}

// In the steady state a hardening spring holds z = c + g phi(z).
TEST(SteadyStartTest, ASpringStartsAtItsOwnEquilibrium) {
  const Effect spring =
      made::effect_of("nonlinear_stiffness", "cubic of the output", {},
                      {{"threshold", "N", 20.0, 0.1, 90.0}}, {-0.02, 0.0, 0.0, 0.0});
  const Body body = made::four_pole_body();
  const Signals signals = signals_of(nearly_constant(9.81), constant(0.0));
  const FreeRun run = free_run(made::model_of(body, {spring}), signals);
  double a = 0.0;
  for (const double c : body.denominator) a += c;
  const double y = run.prediction[10];
  EXPECT_NEAR(y, -3.2 * 9.81 - 0.02 / a * std::pow(y / 20.0, 3), 1e-6);
  EXPECT_GT(std::abs(y + 3.2 * 9.81), 1.0) << "the spring matters";
}

// A channel that swings about 0 for 60 s at 3 Hz; of a first second of 2 V nothing but a lag
// remembers.  Behind a long lag that would be all that is left of it, a drift.
TEST(SteadyStartTest, ALagLongerThanAChannelShowsIsNotProposed) {
  constexpr std::size_t kLong = 6000;
  const auto u = made::ride(kLong, 1);
  auto fast = made::ride(kLong, 2, 2.0, 8.0);
  std::vector<double> slow(kLong);
  std::vector<double> y = made::white(kLong, 3);
  for (std::size_t n = 0; n < kLong; ++n) {
    const double t_s = 0.01 * static_cast<double>(n);
    slow[n] = 23.0 + 2.0 * std::sin(0.2 * t_s);
    y[n] = 0.2 * y[n] + 2.0 * u[n] + 3.0 * std::exp(-t_s / 11.0) +
           0.857 * std::sin(0.2 * t_s - std::atan(0.6));  // behind a lag of 3 s
  }
  for (std::size_t n = 0; n < 101; ++n) fast[n] += 1.0;
  const made::Studied studied(
      made::measurement_of(
          {{"u", "V", u}, {"fast", "V", fast}, {"slow", "degC", slow}, {"y", "N", y}}),
      0);
  double longest_of_slow = 0.0;
  for (const Proposal& proposal : effect_kind("coupled_input").proposed(studied.screening)) {
    if (proposal.effect.form != "lagged") continue;
    const Parameter& lag = proposal.effect.parameters.front();
    if (proposal.effect.channels.front() == "fast") {
      EXPECT_LE(lag.upper, 0.9);
    }
    if (proposal.effect.channels.front() == "slow") longest_of_slow = lag.upper;
  }
  EXPECT_GT(longest_of_slow, 5.0) << "a slow channel may pass a slow path";
}

// Eq. DG-55: of white noise a lag T leaves the share 1/sqrt(2 T f_s), 0.112 at 0.4 s and 0.079 at
// 0.8 s.
TEST(SteadyStartTest, ALagMayBeAsLongAsATenthOfTheChannelPasses) {
  constexpr std::size_t kLong = 6000;
  const auto u = made::ride(kLong, 1);
  const auto noise = made::white(kLong, 2);
  std::vector<double> y(kLong);
  double behind = 0.0;  // a lag of 0.2 s
  for (std::size_t n = 0; n < kLong; ++n) {
    behind += (1.0 - std::exp(-1.0 / 20.0)) * (noise[n] - behind);
    y[n] = 2.0 * u[n] + 3.0 * behind;
  }
  const made::Studied studied(
      made::measurement_of({{"u", "V", u}, {"v", "V", noise}, {"y", "N", y}}), 0);
  std::vector<double> longest_s;
  for (const Proposal& proposal : effect_kind("coupled_input").proposed(studied.screening)) {
    if (proposal.effect.form == "lagged") longest_s.push_back(proposal.effect.parameters[0].upper);
  }
  EXPECT_THAT(longest_s, testing::ElementsAre(0.4));
}

}  // namespace stillhand::diagnosis::steady_start_test
