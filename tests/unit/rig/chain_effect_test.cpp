// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/chain_effect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "services/core/contract/units.hpp"
#include "services/core/rig/parts/body.hpp"

namespace stillhand::rig::chain_effect_test {
namespace {

using Spring = ChainEffect::Spring;

ChainEffect effect_of(Spring spring) {
  ChainEffect effect;
  effect.spring = spring;
  effect.threshold_m = 0.004;
  effect.factor = 0.4;
  effect.time_s = 0.5;
  effect.rest_mass_kg = 2.0;
  effect.rest_frequency_hz = 3.0;
  effect.rest_damping = 0.05;
  effect.pad_stiffness_n_m = 250.0;
  effect.ripple_n = 1.0;
  effect.ripple_period_m = 0.008;
  if (spring == Spring::kHardeningGrip) {
    effect.threshold_m = 0.001;  // the grip stretches less than shoulder and seat
    effect.factor = 3.0;
  }
  return effect;
}

const std::vector<Spring> kInBody{Spring::kSofteningShoulder,
                                  Spring::kHardeningGrip,
                                  Spring::kOneWayShoulder,
                                  Spring::kSlackHarness,
                                  Spring::kBumpStop,
                                  Spring::kTighteningArm,
                                  Spring::kArmRest};

/// Springs of the chain as METHOD Eq. RG-14 to RG-19 write them, whole and not as differences.
struct Springs {
  std::function<double(double)> seat, shoulder, grip;
  double rest_on_arm_n_m = 0.0;  ///< stiffness that the arm rest adds at the arm, at rest
  double rest_pull_kg = 0.0;     ///< and its force per acceleration
};

Springs springs_of(Spring spring, const BodyConfig& b) {
  const ChainEffect e = effect_of(spring);
  const double h = e.threshold_m;
  Springs s{[&b](double x) { return b.seat_stiffness_n_m * x; },
            [&b](double d) { return b.shoulder_stiffness_n_m * d; },
            [&b](double x) { return b.grip_stiffness_n_m * x; }};
  switch (spring) {
    case Spring::kSofteningShoulder:
      s.shoulder = [=](double d) {
        return b.shoulder_stiffness_n_m * ((1.0 - e.factor) * d + e.factor * h * std::tanh(d / h));
      };
      break;
    case Spring::kHardeningGrip:
      s.grip = [=](double x) {
        return b.grip_stiffness_n_m * (x + e.factor * std::pow(x, 3) / (h * h + x * x));
      };
      break;
    case Spring::kOneWayShoulder:
      s.shoulder = [=](double d) {
        return b.shoulder_stiffness_n_m * d * (d > 0.0 ? 1.0 + e.factor : 1.0 - e.factor);
      };
      break;
    case Spring::kSlackHarness:
      s.seat = [=](double x) {
        const double taut = std::abs(x) < h ? 0.0 : x - std::copysign(h, x);
        return b.seat_stiffness_n_m * ((1.0 - e.factor) * x + e.factor * taut);
      };
      break;
    case Spring::kBumpStop:
      s.seat = [=](double x) {
        const double pressed = std::abs(x) < h ? 0.0 : x - std::copysign(h, x);
        return b.seat_stiffness_n_m * (x + e.factor * pressed);
      };
      break;
    case Spring::kTighteningArm:
      s.shoulder = [=](double d) { return (1.0 + e.factor) * b.shoulder_stiffness_n_m * d; };
      s.grip = [=](double x) { return (1.0 + e.factor) * b.grip_stiffness_n_m * x; };
      break;
    case Spring::kArmRest: {
      const double own = e.rest_mass_kg * std::pow(kTwoPi * e.rest_frequency_hz, 2);
      s.rest_on_arm_n_m = e.pad_stiffness_n_m * (1.0 - e.pad_stiffness_n_m / own);
      s.rest_pull_kg = e.pad_stiffness_n_m * e.rest_mass_kg / own;
      break;
    }
    default:
      break;
  }
  return s;
}

double root(const std::function<double(double)>& rising, double low, double high) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (rising(middle) > 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// Load-cell force of the held stick under a constant acceleration, from the balance of forces:
/// shoulder d given, both masses follow.
double balanced_force(const Springs& s, const BodyConfig& b, double cell_mass_kg, double a_m_s2) {
  const auto arm_at = [&](double trunk_m) {
    return root(
        [&](double arm_m) {
          return s.shoulder(arm_m - trunk_m) + s.grip(arm_m) + s.rest_on_arm_n_m * arm_m +
                 (b.arm_mass_kg + s.rest_pull_kg) * a_m_s2;
        },
        -1.0, 1.0);
  };
  const double trunk_m = root(
      [&](double x) { return s.seat(x) - s.shoulder(arm_at(x) - x) + b.trunk_mass_kg * a_m_s2; },
      -1.0, 1.0);
  return s.grip(arm_at(trunk_m)) - cell_mass_kg * a_m_s2;
}

// At rest a force held over the tick is exact: what is left is the slowest mode, e^(-2 z w t) with
// z w above 1 /s (the arm rest's 0.05 2 pi 3), after 40 s, and the bisection's 2^-200.
TEST(ChainEffectTest, HeldForceUnderConstantAccelerationIsTheBalanceOfTheSpringsAsWritten) {
  const BodyConfig body;
  const StickConfig stick;
  for (const Spring spring : kInBody) {
    for (const double a_m_s2 : {-4.0, -0.5, 2.0, 5.0}) {
      Body sut(body, stick, kControlPeriod_s, effect_of(spring));
      Body::Output out{};
      for (int n = 0; n < 40000; ++n) out = sut.step({a_m_s2, 0.0, 0.0, true});
      const double expected_n = balanced_force(springs_of(spring, body), body,
                                               body.hand_mass_kg + stick.handle_mass_kg, a_m_s2);
      EXPECT_NEAR(out.hand_force_n, expected_n, 1e-9) << static_cast<int>(spring) << ' ' << a_m_s2;
      EXPECT_NEAR(out.feedthrough_force_n, expected_n, 1e-9) << static_cast<int>(spring);
    }
  }
}

/// Force and angle over 5 s of shaking, stick free, at `split` steps a tick; every 1 ms.
std::vector<Body::Output> shaken(const ChainEffect& effect, int split) {
  StickConfig stick;
  stick.coulomb_friction_n = 0.0;  // RG-10 has its own figure with it
  Body sut(BodyConfig{}, stick, kControlPeriod_s / split, effect);
  // From rest, without a jump: how a jump lies between two samples is another question.
  const auto at = [](double t_s) {
    return std::clamp(t_s, 0.0, 1.0) *
           (3.0 * std::sin(kTwoPi * 0.9 * t_s) + 2.0 * std::sin(kTwoPi * 2.3 * t_s + 1.0));
  };
  std::vector<Body::Output> out;
  for (int n = 1; n <= 5000; ++n) {
    const double from = at((n - 1) * kControlPeriod_s);
    const double to = at(n * kControlPeriod_s);
    Body::Output now{};
    for (int k = 1; k <= split; ++k) {
      const double share = static_cast<double>(k) / split;
      now = sut.step({from + share * (to - from), 0.0, 0.0, false});
    }
    out.push_back(now);
  }
  return out;
}

// Measured: 8e-6 rad and 1e-3 N at most, 0.011 N for the grip, whose stiffness triples within a
// millimetre (METHOD Eq. RG-13).  The bounds are twice that.
TEST(ChainEffectTest, AHeldDifferenceForceAgreesWithATenTimesFinerStep) {
  std::vector<Spring> springs = kInBody;
  springs.push_back(Spring::kCogging);
  for (const Spring spring : springs) {
    const auto coarse = shaken(effect_of(spring), 1);
    const auto fine = shaken(effect_of(spring), 10);
    const auto plain = shaken({}, 1);
    double angle_rad = 0.0;
    double force_n = 0.0;
    double acts_n = 0.0;
    for (std::size_t n = 0; n < coarse.size(); ++n) {
      angle_rad = std::max(angle_rad, std::abs(coarse[n].theta_rad - fine[n].theta_rad));
      force_n =
          std::max(force_n, std::abs(coarse[n].feedthrough_force_n - fine[n].feedthrough_force_n));
      acts_n = std::max(acts_n, std::abs(coarse[n].hand_force_n - plain[n].hand_force_n));
    }
    std::printf("spring %d: %.2g rad, %.2g N; acts with %.2g N\n", static_cast<int>(spring),
                angle_rad, force_n, acts_n);
    EXPECT_LT(angle_rad, 2e-5) << static_cast<int>(spring);
    EXPECT_LT(force_n, spring == Spring::kHardeningGrip ? 0.022 : 2e-3) << static_cast<int>(spring);
    EXPECT_GT(acts_n, 0.03) << static_cast<int>(spring);
  }
}

TEST(ChainEffectTest, CoggingIsASineOfTheStickSPlaceBelowTheLoadCell) {
  ChainEffect effect = effect_of(Spring::kCogging);
  effect.ripple_phase_rad = 0.3;
  const EffectOnChain sut(effect, kControlPeriod_s);
  const auto p = chain_parameters(BodyConfig{}, StickConfig{}, false);
  for (const double stick_m : {-0.003, 0.0, 0.001, 0.0095}) {
    const auto f = sut.forces({0.0, 0.0, 0.0, 0.0, stick_m, 0.0}, p);
    EXPECT_DOUBLE_EQ(f.stick_n, std::sin(kTwoPi * stick_m / 0.008 + 0.3));
    EXPECT_EQ(f.hand_n, 0.0);
  }
}

TEST(ChainEffectTest, FrictionOfTheEffectIsAddedToTheStickSOwn) {
  const StickConfig rough{.coulomb_friction_n = 1.2};
  const ChainEffect effect{.friction_n = 1.0};
  Body sut(BodyConfig{}, StickConfig{}, kControlPeriod_s, effect);  // 0.2 N of its own
  Body declared(BodyConfig{}, rough);
  for (int n = 0; n < 3000; ++n) {
    const Body::Input input{3.0 * std::sin(0.01 * n), 0.0, 0.0, false};
    EXPECT_EQ(sut.step(input).hand_force_n, declared.step(input).hand_force_n);
  }
}

// 1 - exp(-t/tau): after five time constants 0.7 % of the growth is left.  Springs and dampers
// grow.
TEST(ChainEffectTest, AnArmThatTightensPassesFromItsOwnStiffnessToTheLast) {
  ChainEffect effect = effect_of(Spring::kTighteningArm);
  EffectOnChain sut(effect, kControlPeriod_s);
  const auto p = chain_parameters(BodyConfig{}, StickConfig{}, true);
  const ChainPlace at{0.002, 0.01, 0.003, 0.05, 0.001, 0.02};
  EXPECT_EQ(sut.forces(at, p).hand_n, 0.0);
  for (int n = 0; n < 2500; ++n) sut.age();
  const double more = 0.4 * (1.0 - std::exp(-5.0));
  const double shoulder_n =
      more * (p.shoulder_stiffness_n_m * 0.001 + p.shoulder_damping_n_s_m * 0.04);
  const double grip_n = more * (p.grip_stiffness_n_m * 0.002 + p.grip_damping_n_s_m * 0.03);
  const ChainForces f = sut.forces(at, p);
  EXPECT_NEAR(f.trunk_n, shoulder_n, 1e-9);
  EXPECT_NEAR(f.arm_n, -shoulder_n - grip_n, 1e-9);
  EXPECT_NEAR(f.hand_n, grip_n, 1e-9);
}

}  // namespace
}  // namespace stillhand::rig::chain_effect_test
