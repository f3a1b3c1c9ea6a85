// SPDX-License-Identifier: Apache-2.0
// Effects outside of the kinds: what is drawn, and that each acts as its equation says.
#include "services/core/rig/undeclared/outside_draw.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/body.hpp"
#include "services/core/rig/rig.hpp"

namespace stillhand::rig::outside_draw_test {
namespace {

using Spring = ChainEffect::Spring;

double number(const EffectPlan& plan, const std::string& name) {
  for (const auto& each : plan.facts.parameters) {
    if (each.name == name) return each.value;
  }
  return 0.0;
}

// Numbers of one seed of each kind stay as they are, to the bisection's 0.1 %.
TEST(OutsideDrawTest, SeedsDrawEveryEffectNearTheThresholdAndFarAboveIt) {
  std::map<std::uint64_t, std::vector<double>> kept{
      {1, {0.0704225, 300.0, 0.122418, 0.816667, 0.0343092}},
      {7, {0.618077, 126.548, 0.198554, 1.32458, 0.0325993}},
      {11, {3867.79, 0.518407, 3.45836, 0.735066}},
      {17, {12.0443, 0.208614}},
      {21, {2.98455, 0.00280725, 0.85216, 0.0575031, 0.38361, 0.0622781}}};
  std::set<std::string> drawn;
  std::size_t small = 0;
  std::size_t large = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const EffectPlan sut = draw_outside(seed, RigConfig{});
    drawn.insert(sut.facts.kind + " " + sut.facts.place);
    const double force_n = number(sut, "force_rms");
    EXPECT_GT(force_n, 0.0) << seed;
    const double beyond_n = number(sut, "force_beyond_linear");
    if (sut.facts.kind == "delayed_reflex" || sut.facts.kind == "fractional_damping") {
      EXPECT_LT(beyond_n, 0.01 * 7.0) << seed << ": linear";
    } else if (sut.facts.place != "drive") {
      EXPECT_GT(beyond_n, 0.1 * force_n) << seed;
      EXPECT_LT(beyond_n, force_n) << seed;
    }
    // 0.3 of 7 N lies between the two ranges of the body, 0.5 N between those of the drive.
    (force_n < (sut.facts.place == "drive" ? 0.5 : 2.1) ? small : large) += 1;
    const std::vector<double>& numbers = kept[seed];
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      EXPECT_NEAR(sut.facts.parameters.at(i).value, numbers[i], 1e-3 * numbers[i]) << seed;
    }
  }
  EXPECT_EQ(drawn, (std::set<std::string>{"delayed_reflex shoulder", "square_drag arm",
                                          "square_drag drive", "fractional_damping shoulder",
                                          "vibration_grip grip"}));
  EXPECT_GE(small, 6u);
  EXPECT_GE(large, 4u) << "a reflex and a stiffer grip do not reach that far";
}

TEST(OutsideDrawTest, ASeedIsTheSameEffectAndTheOtherSourceAnotherOne) {
  const RigConfig rig;
  for (const std::uint64_t seed : {3u, 9u}) {
    const OpenedEffect first = SealedEffect(seed, rig, EffectSource::kOutsideKinds).open();
    const OpenedEffect second = SealedEffect(seed, rig, EffectSource::kOutsideKinds).open();
    EXPECT_EQ(first.kind, second.kind);
    ASSERT_EQ(first.parameters.size(), second.parameters.size());
    for (std::size_t i = 0; i < first.parameters.size(); ++i) {
      EXPECT_EQ(first.parameters[i].value, second.parameters[i].value);
    }
    EXPECT_NE(first.kind, SealedEffect(seed, rig).open().kind);
  }
}

// Every effect stays bounded on a free and on a pegged stick, with the largest sizes.
TEST(OutsideDrawTest, NoEffectMakesTheHandUnstable) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const EffectPlan plan = draw_outside(seed, RigConfig{});
    StickConfig stick;
    stick.coulomb_friction_n = 0.0;  // it would hold the stick against the springs
    Body sut(BodyConfig{}, stick, kControlPeriod_s, plan.chain);
    for (int n = 0; n < 2000; ++n) {
      sut.step({3.0 * std::sin(kTwoPi * 1.3e-3 * n), 0.0, 0.0, false});
    }
    for (int n = 0; n < 20000; ++n) sut.step({0.0, 0.0, 0.0, false});
    EXPECT_LT(sut.energy_j(), 1e-6) << seed << plan.facts.kind;
  }
}

TEST(OutsideEffectTest, TheReflexComesAfterItsDelay) {
  ChainEffect effect;
  effect.spring = Spring::kDelayedReflex;
  effect.outside = 100.0;
  effect.time_s = 0.04;
  EffectOnChain sut(effect, kControlPeriod_s);
  const auto p = chain_parameters({}, {}, false);
  // 5 mm of stretch, and 0.03 s of 0.2 m/s.
  const ChainPlace stretched{0.005, 0.1, 0.01, 0.3, 0.0, 0.0};
  // The sample that the delay line returns is 40 ticks old: the force comes with the 41st.
  for (int n = 0; n < 40; ++n) {
    sut.move(stretched, stretched, 0.0);
    EXPECT_EQ(sut.forces(stretched, p).arm_n, 0.0) << n;
  }
  sut.move(stretched, stretched, 0.0);
  EXPECT_DOUBLE_EQ(sut.forces(stretched, p).arm_n, -1.1);
  EXPECT_DOUBLE_EQ(sut.forces(stretched, p).trunk_n, 1.1);
}

TEST(OutsideEffectTest, DragIsSquareAndOpposesTheMotion) {
  ChainEffect effect{.outside = 50.0};
  const auto p = chain_parameters({}, {}, false);
  for (const double v : {-0.4, -0.1, 0.0, 0.2}) {
    effect.spring = Spring::kArmDrag;
    EXPECT_DOUBLE_EQ(
        EffectOnChain(effect, kControlPeriod_s).forces({0.0, 0.0, 0.0, v, 0.0, 0.0}, p).arm_n,
        -50.0 * v * std::abs(v));
    effect.spring = Spring::kStickDrag;
    EXPECT_DOUBLE_EQ(
        EffectOnChain(effect, kControlPeriod_s).forces({0.0, 0.0, 0.0, 0.0, 0.0, v}, p).stick_n,
        -50.0 * v * std::abs(v));
  }
}

// s^a = (j w)^a.  What the ladder lacks below its lowest rate l is (l/w)^a sin(a pi)/(a pi), 15 %
// at 0.7 Hz with a = 0.3; above its highest, h, it is (w/h)^(1-a) sin(a pi)/((1-a) pi), 21 % at 3
// Hz with a = 0.7.  The sum over lags takes half a step of each away, or adds it.
TEST(OutsideEffectTest, TheLadderIsADerivativeOfFractionalOrder) {
  for (const double a : {0.3, 0.5, 0.7}) {
    for (const double hz : {0.7, 1.3, 3.0}) {
      FractionalLadder sut(a, kControlPeriod_s);
      std::complex<double> sum;
      constexpr int kSettle = 20000;
      constexpr int kTicks = 10000;
      for (int n = 1; n <= kSettle + kTicks; ++n) {
        const double phase = kTwoPi * hz * n * kControlPeriod_s;
        sut.step(std::cos(phase));
        if (n > kSettle) sum += sut.derivative(std::cos(phase)) * std::polar(1.0, -phase);
      }
      const std::complex<double> got = sum * (2.0 / kTicks);
      const std::complex<double> wanted = std::pow(std::complex<double>(0.0, kTwoPi * hz), a);
      EXPECT_LT(std::abs(got - wanted) / std::abs(wanted), 0.3) << a << ' ' << hz;
    }
  }
}

TEST(OutsideEffectTest, TheGripStiffensWithTheVibrationsRunningSize) {
  ChainEffect effect;
  effect.spring = Spring::kVibrationGrip;
  effect.factor = 2.0;
  effect.threshold_m = 0.001;
  effect.time_s = 0.5;
  EffectOnChain sut(effect, kControlPeriod_s);
  const auto p = chain_parameters({}, {}, false);
  const ChainPlace gripped{0.0, 0.0, 0.001, 0.0, 0.0, 0.0};
  EXPECT_EQ(sut.forces(gripped, p).hand_n, 0.0) << "no vibration before";
  // After ten time constants the mean square is h^2 to 5e-5: half of the factor.
  for (int n = 0; n < 5000; ++n) sut.move(gripped, gripped, 0.0);
  EXPECT_NEAR(sut.forces(gripped, p).hand_n, 0.5 * 2.0 * p.grip_stiffness_n_m * 0.001, 1e-3);
}

}  // namespace
}  // namespace stillhand::rig::outside_draw_test
