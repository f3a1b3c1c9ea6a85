// SPDX-License-Identifier: Apache-2.0
// Columns of modes and of friction, Eq. DG-6, each by its own equation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

constexpr std::size_t kCount = 400;
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

Columns columns_of(const Effect& effect, const Signals& signals) {
  Columns columns;
  effect_kind(effect.kind)
      .terms(effect, signals, std::vector<double>(signals.size(), 0.0), columns);
  return columns;
}

// x = u / M(q) by the recursion written out, and its difference.
TEST(DynamicTermsTest, AModeIsItsRecursionAndItsDifference) {
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

// A mode rings for 1/(2 pi f z) s.  The record has 4.493 s, an eighth of it 0.5616 s.
TEST(DynamicTermsTest, AModeThatRingsThroughTheRecordHasNoFreeResponse) {
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
TEST(DynamicTermsTest, ALevelThatLastsIsFittedToTheRowsThatMaySay) {
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

TEST(DynamicTermsTest, ASmoothSignIsHalfwayAtItsTransition) {
  std::vector<double> rate(kCount, 0.0);
  rate[0] = 0.25;
  rate[1] = -0.25;
  rate[2] = 1e9;
  const auto sut = columns_of({"coulomb_friction",
                               "smooth sign, beside the body",
                               {"theta"},
                               {{"transition_rate", "rad/s", 0.25, 0.0, 9.0}},
                               {}},
                              signals_of(rate));
  EXPECT_DOUBLE_EQ(sut[0][0], std::tanh(1.0));
  EXPECT_DOUBLE_EQ(sut[0][1], -std::tanh(1.0));
  EXPECT_EQ(sut[0][2], 1.0);
  EXPECT_EQ(sut[0][3], 0.0);
}

// A rate that crosses zero between two samples has a share of both signs; at rest there is none.
TEST(DynamicTermsTest, ASharpSignHasAShareOfBothWhereItCrosses) {
  std::vector<double> rate(kCount, 0.0);
  for (std::size_t n = 0; n < 200; ++n) rate[n] = n % 2 == 0 ? 1.0 : -1.0;
  const auto sut =
      columns_of({"coulomb_friction", "sign, beside the body", {"theta"}, {}, {}}, signals_of(rate))
          .at(0);
  for (std::size_t n = 1; n + 1 < kCut; ++n) ASSERT_EQ(sut[n], rate[n]) << n;
  for (std::size_t n = 201; n < kCount; ++n) ASSERT_EQ(sut[n], 0.0) << n;
}

}  // namespace
}  // namespace stillhand::diagnosis
