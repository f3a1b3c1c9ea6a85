// SPDX-License-Identifier: Apache-2.0
// Columns of the kinds that are added next to the body, Eq. DG-6, each by its own equation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::effect_terms_test {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;

constexpr std::size_t kCount = 401;
constexpr std::size_t kCut = 150;
constexpr double kPause_s = 0.503;

// Two stretches, the second one half a second late.
Signals signals_of(std::vector<double> theta) {
  return {made::cut_in_two(made::measurement_of({{"u", "m/s^2", made::white(kCount, 1)},
                                                 {"theta", "rad", std::move(theta)},
                                                 {"temp", "degC", made::white(kCount, 3)},
                                                 {"y", "N", made::white(kCount, 4)}}),
                           kCut, kPause_s),
          {"u"},
          "y"};
}

Signals wandering() { return signals_of(made::ride(kCount, 2, 0.3, 2.0)); }

double time_s(std::size_t n) {
  return static_cast<double>(n) / made::kRateHz + (n >= kCut ? kPause_s : 0.0);
}

Columns columns_of(const Effect& effect, const Signals& signals) {
  Columns columns;
  effect_kind(effect.kind)
      .terms(effect, signals, std::vector<double>(signals.size(), 0.0), columns);
  return columns;
}

// 4 s of 9.3 Hz: arguments below 300, a rounding of 3e-14 each.
TEST(EffectTermsTest, AToneKeepsItsPhaseOverAGap) {
  const auto sut =
      columns_of({"tone", "", {}, {{"frequency", "Hz", 9.3, 9.0, 9.6}}, {}}, wandering());
  ASSERT_EQ(sut.size(), 2u);
  for (std::size_t n = 0; n < kCount; ++n) {
    ASSERT_NEAR(sut[0][n], std::sin(kTwoPi * 9.3 * time_s(n)), 1e-12) << n;
    ASSERT_NEAR(sut[1][n], std::cos(kTwoPi * 9.3 * time_s(n)), 1e-12) << n;
  }
}

TEST(EffectTermsTest, ADriftIsAFunctionOfTheTimeSinceTheStart) {
  const Signals signals = wandering();
  const double length_s = time_s(kCount - 1);
  const auto linear = columns_of({"drift", "linear", {}, {}, {}}, signals);
  ASSERT_EQ(linear.size(), 1u);
  EXPECT_EQ(linear[0].front(), -0.5);
  EXPECT_EQ(linear[0].back(), 0.5);
  EXPECT_NEAR(linear[0][kCut] - linear[0][kCut - 1], (0.01 + kPause_s) / length_s, 1e-14);
  const auto exponential = columns_of(
      {"drift", "exponential", {}, {{"time_constant", "s", 0.5, 0.1, 9.0}}, {}}, signals);
  ASSERT_EQ(exponential.size(), 1u);
  EXPECT_EQ(exponential[0].front(), 1.0);
  EXPECT_NEAR(exponential[0][50], std::exp(-1.0), 1e-15 * 10.0);
  EXPECT_NEAR(exponential[0][kCut], std::exp(-2.0 * time_s(kCut)), 1e-15 * 10.0);
  const auto cosines = columns_of({"drift", "slow cosines", {}, {}, {}}, signals);
  ASSERT_EQ(cosines.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(cosines[k].front(), 1.0);
    EXPECT_NEAR(cosines[k].back(), k == 1 ? 1.0 : -1.0, 1e-15);
  }
}

TEST(EffectTermsTest, ARippleRepeatsWithThePosition) {
  constexpr double kPerRad = 2.5;  // a period of 0.4 rad
  std::vector<double> theta(kCount);
  for (std::size_t n = 0; n < kCount; ++n) theta[n] = 0.1 * static_cast<double>(n % 40);
  const auto sut = columns_of(made::effect_of("position_ripple", "two harmonics", {"theta"},
                                              {{"spatial_frequency", "1/rad", kPerRad, 2.0, 3.0}}),
                              signals_of(theta));
  ASSERT_EQ(sut.size(), 4u);
  for (std::size_t n = 0; n + 4 < 40; ++n) {
    for (const auto& column : sut) EXPECT_NEAR(column[n], column[n + 4], 1e-13);
    EXPECT_NEAR(sut[0][n] * sut[0][n] + sut[1][n] * sut[1][n], 1.0, 1e-15 * 10.0);
    // Twice the angle.
    EXPECT_NEAR(sut[2][n], 2.0 * sut[0][n] * sut[1][n], 1e-13);
    EXPECT_NEAR(sut[3][n], sut[1][n] * sut[1][n] - sut[0][n] * sut[0][n], 1e-13);
  }
}

// x(n) = x(n-1) + (1 - e^(-T/lag)) (u(n) - x(n-1)), settled on the stretch's level
// (DG-54).
TEST(EffectTermsTest, ALaggedPathSettlesAgainInEveryStretch) {
  constexpr double kLag_s = 0.15;
  const Effect effect{"coupled_input", "lagged", {"theta"}, {{"lag", "s", kLag_s, 0.0, 9.0}}, {}};
  const Signals signals = wandering();
  const auto& theta = signals.at("theta").values;
  const auto sut = columns_of(effect, signals);
  ASSERT_EQ(sut.size(), 1u);
  const double share = -std::expm1(-1.0 / (kLag_s * made::kRateHz));
  for (const auto& [first, end] : {std::pair{std::size_t{0}, kCut}, std::pair{kCut, kCount}}) {
    double state = made::level_of({theta.begin() + static_cast<std::ptrdiff_t>(first),
                                   theta.begin() + static_cast<std::ptrdiff_t>(end)});
    for (std::size_t n = first; n < end; ++n) {
      state += share * (theta[n] - state);
      // 101 roundings of numbers near 1, and as many that fade.
      ASSERT_NEAR(sut[0][n], state, 1e-13) << n;
    }
  }
}

TEST(EffectTermsTest, AConstantPassesALagUnchanged) {
  std::vector<double> theta(kCount, 0.75);
  theta[kCount - 1] = 5.0;  // a constant channel explains nothing
  const auto sut = columns_of(
      {"coupled_input", "lagged", {"theta"}, {{"lag", "s", 3.0, 0.0, 9.0}}, {}}, signals_of(theta));
  for (std::size_t n = 0; n + 1 < kCount; ++n) ASSERT_NEAR(sut[0][n], 0.75, 1e-14) << n;
}

TEST(EffectTermsTest, PathsFromSeveralChannelsAreSeveralColumns) {
  const Signals signals = wandering();
  const auto sut =
      columns_of({"coupled_input", "static with rate", {"theta", "temp"}, {}, {}}, signals);
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(sut[0], signals.at("theta").values);
  EXPECT_EQ(sut[1], signals.at("temp").values);
}

// Half width 0.5 about a centre of 0.25: from -0.25 to 0.75.
TEST(EffectTermsTest, PlayOfAPositionIsCountedFromItsCentre) {
  std::vector<double> theta(kCount, 0.0);
  const double some[] = {-1.25, -0.25, 0.0, 0.75, 2.0};
  std::copy(std::begin(some), std::end(some), theta.begin());
  const auto sut =
      columns_of(made::effect_of("dead_zone", "beside the body", {"theta"},
                                 {{"half_width", "rad", 0.5}, constant("centre", "rad", 0.25)}),
                 signals_of(theta));
  ASSERT_EQ(sut.size(), 1u);
  EXPECT_THAT(std::vector<double>(sut[0].begin(), sut[0].begin() + 5),
              ElementsAre(-1.0, 0.0, 0.0, 0.0, 1.25));
}

TEST(EffectTermsTest, ACubicSpringHasALinearPart) {
  const Signals signals = wandering();
  const auto sut = columns_of(made::effect_of("nonlinear_stiffness", "cubic, beside the body",
                                              {"theta"}, {constant("centre", "rad", 0.25)}),
                              signals);
  ASSERT_EQ(sut.size(), 2u);
  for (std::size_t n = 0; n < kCount; ++n) {
    const double x = signals.at("theta").values[n] - 0.25;
    ASSERT_EQ(sut[0][n], x);
    ASSERT_EQ(sut[1][n], x * x * x);
  }
}

TEST(EffectTermsTest, AnEvenPartIsASquareOrASizeByItsForm) {
  const Signals signals = wandering();
  const auto of_form = [&](const char* form) {
    return columns_of({"asymmetry", form, {"theta"}, {constant("centre", "rad", 0.5)}, {}}, signals)
        .at(0);
  };
  const auto square = of_form("square, beside the body");
  const auto size = of_form("slopes, beside the body");
  for (std::size_t n = 0; n < kCount; ++n) {
    const double x = signals.at("theta").values[n] - 0.5;
    ASSERT_EQ(square[n], x * x);
    ASSERT_EQ(size[n], std::abs(x));
  }
}

TEST(EffectTermsTest, AProductIsThatOfTheDeviationsFromTheCentres) {
  const Signals signals = wandering();
  const auto sut = columns_of(
      made::effect_of("bilinear", "beside the body", {"theta", "temp"},
                      {constant("centre_1", "rad", 0.5), constant("centre_2", "", -2.0)}),
      signals);
  ASSERT_EQ(sut.size(), 1u);
  for (std::size_t n = 0; n < kCount; ++n) {
    ASSERT_EQ(sut[0][n],
              (signals.at("theta").values[n] - 0.5) * (signals.at("temp").values[n] + 2.0));
  }
}

// The input's own linear path is the body's: hysteresis of it adds its state alone.
TEST(EffectTermsTest, HysteresisOfAPositionHasALinearPartUnlessItIsTheInput) {
  const Signals signals = wandering();
  const auto of_channel = [&](const char* channel) {
    return columns_of(made::effect_of("hysteresis", "elastic-plastic, beside the body", {channel},
                                      {{"threshold", "rad", 0.5, 0.0, 9.0}}),
                      signals);
  };
  const auto sut = of_channel("theta");
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(sut[1], signals.at("theta").values);
  EXPECT_EQ(sut[0][0], 0.0);
  EXPECT_EQ(sut[0][kCut], 0.0) << "a stretch starts from rest";
  EXPECT_EQ(of_channel("u").size(), 1u);
}

// x = u / M(q) by the recursion written out, and its difference.
TEST(EffectTermsTest, AModeIsItsRecursionAndItsDifference) {
  const Effect effect{
      "resonance", "", {}, {{"frequency", "Hz", 6.0}, {"damping_ratio", "-", 0.2}}, {}};
  const Signals signals = wandering();
  const auto& u = signals.at("u").values;
  const auto sut = columns_of(effect, signals);
  ASSERT_EQ(sut.size(), 2u);
  const auto denominator = made::mode(6.0, 0.2);
  const auto first = made::settled_answer({1.0}, denominator, {u.begin(), u.begin() + kCut});
  const auto second = made::settled_answer({1.0}, denominator, {u.begin() + kCut, u.end()});
  std::vector<double> want = first;
  want.insert(want.end(), second.begin(), second.end());
  // A gain of 1/(1 - r)^2 = 200 at most, 400 roundings.
  EXPECT_THAT(sut[1], Pointwise(DoubleNear(1e-11), want));
  for (std::size_t n = 1; n < kCount; ++n) {
    if (n == kCut) continue;
    // Rounding of 7.
    ASSERT_NEAR(sut[0][n], sut[1][n] - sut[1][n - 1], 1e-14) << n;
  }
}

// A mode rings for 1/(2 pi f z) s.  The record has 4.503 s, an eighth of it 0.5629 s.
TEST(EffectTermsTest, AModeThatRingsThroughTheRecordHasNoFreeResponse) {
  const Signals signals = wandering();
  const auto ringing_left = [&](double damping_ratio) {
    Model model = made::model_of({{{1.0}}, {1.0}, 0.0});
    model.effects = {
        {"resonance", "", {}, {{"frequency", "Hz", 2.0}, {"damping", "-", damping_ratio}}, {}}};
    std::vector<double> pulse(signals.size(), 0.0);
    pulse[signals.stretches().front().first] = 1.0;
    const auto ringing = through_poles(pulse, mode_denominator(2.0, damping_ratio, made::kRateHz),
                                       signals.stretches());
    const std::vector<double> weight(signals.size(), 1.0);
    const Eigen::Map<const Eigen::VectorXd> column(ringing.data(), std::ssize(ringing));
    const Eigen::VectorXd part = InitialStates(model, signals, weight).part_of(column);
    return (column - part).norm() / column.norm();
  };
  const double least = 1.0 / (kTwoPi * 2.0 * 0.125 * signals.duration_s());
  EXPECT_DOUBLE_EQ(ringing_left(0.99 * least), 1.0);
  EXPECT_LT(ringing_left(1.01 * least), 2e-3);  // it counts until it has decayed to 1e-3
}

// A level in the last quarter alone: what it says of the start counts where its rows may.
TEST(EffectTermsTest, ALevelThatLastsIsFittedToTheRowsThatMaySay) {
  const Signals slow = wandering().with_slow_poles();
  const std::size_t last = 3 * slow.size() / 4;
  Eigen::VectorXd column = Eigen::VectorXd::Zero(std::ssize(slow.weight()));
  column.tail(std::ssize(slow.weight()) - static_cast<Eigen::Index>(last)).setOnes();
  std::vector<bool> rows(slow.size(), true);
  std::fill(rows.begin() + static_cast<std::ptrdiff_t>(last), rows.end(), false);
  const Body body{{{0.0, 1.0}}, {1.0, -std::exp(-1e-3 / static_cast<double>(slow.size()))}, 0.0};
  const std::vector<double> weight(slow.size(), 1.0);
  EXPECT_GT(InitialStates(body, slow, weight).part_of(column).norm(), 0.4 * column.norm());
  EXPECT_LT(InitialStates(body, slow.starting_by(rows), weight).part_of(column).norm(),
            1e-9 * column.norm());
}

TEST(EffectTermsTest, ASmoothSignIsHalfwayAtItsTransition) {
  std::vector<double> rate(kCount, 0.0);
  rate[0] = 0.25;
  rate[1] = -0.25;
  rate[2] = 1e9;
  const auto sut =
      columns_of(made::effect_of("coulomb_friction", "smooth sign, beside the body", {"theta"},
                                 {{"transition_rate", "rad/s", 0.25, 0.0, 9.0}}),
                 signals_of(rate));
  EXPECT_DOUBLE_EQ(sut[0][0], std::tanh(1.0));
  EXPECT_DOUBLE_EQ(sut[0][1], -std::tanh(1.0));
  EXPECT_EQ(sut[0][2], 1.0);
  EXPECT_EQ(sut[0][3], 0.0);
}

}  // namespace stillhand::diagnosis::effect_terms_test
