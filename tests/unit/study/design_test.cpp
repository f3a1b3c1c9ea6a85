// SPDX-License-Identifier: Apache-2.0
// Parameters by optimisation over a population of arms: Eqs. MI-7 and MI-8.
#include "apps/study/mitigations/design.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/admittance/arm_fit.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::study::design_test {
namespace {

// A gain alone, which is a model of order 1 with no dynamics.
signal::DifferenceModel gain_model(double gain) { return {1000.0, {gain, 0.0}, {1.0, 0.0}}; }

const std::vector<PowerLine> kSlow{{0.1, 1.0}, {0.2, 1.0}};
const std::vector<PowerLine> kBand{{0.7, 1.0}, {1.0, 1.0}, {1.4, 1.0}, {2.0, 1.0}};

admittance::ArmValues arm_of(double stiffer) {
  admittance::ArmValues arm = admittance::mean_arm();
  arm[admittance::kArmStiffness] *= stiffer;
  arm[admittance::kGripStiffness] *= stiffer;
  return arm;
}

double slow_gain(const admittance::ArmValues& arm) {
  return admittance::arm_response(arm, 0.1).feedthrough.real();
}

// At 0.1 and 0.2 Hz an arm's feedthrough is a gain, to 1 %; its own gain is the best.
TEST(ChooseReducedTest, TakesTheWholeModelOfTheOnlyPerson) {
  const admittance::ArmValues arm = arm_of(1.0);
  const auto sut = choose_reduced({{{arm}, {gain_model(slow_gain(arm))}}}, kSlow, {});
  EXPECT_EQ(sut.order, 1U);
  EXPECT_NEAR(sut.gain, 1.0, 1e-9);
  EXPECT_LT(sut.worst, 0.03);
}

// Two people whose models differ by the factor 2: with gain g the model of h leaves |1 - 2 g| of
// the weak one and |1 - g/2| of the strong one; both are 0.6 at g = 0.8.
TEST(ChooseReducedTest, LowersTheGainWhereModelsDiffer) {
  const admittance::ArmValues arm = arm_of(1.0);
  const double h = slow_gain(arm);
  const auto sut =
      choose_reduced({{{arm}, {gain_model(0.5 * h)}}, {{arm}, {gain_model(2.0 * h)}}}, kSlow, {});
  EXPECT_NEAR(sut.gain, 0.8, 1e-9);
  EXPECT_NEAR(sut.worst, 0.6, 0.02);
}

TEST(ChooseReducedTest, DoesNothingRatherThanHarm) {
  const admittance::ArmValues arm = arm_of(1.0);
  const auto sut = choose_reduced({{{arm}, {gain_model(-slow_gain(arm))}}}, kSlow, {});
  EXPECT_EQ(sut.gain, 0.0);
  EXPECT_EQ(sut.worst, 1.0);
}

TEST(ChooseReducedTest, RefusesNobody) {
  EXPECT_THROW(choose_reduced({}, kSlow, {}), ConfigError);
  EXPECT_THROW(choose_reduced({{{arm_of(1.0)}, {}}}, kSlow, {}), ConfigError);
}

TEST(ChooseImpedanceTest, KeepsItsBoundsAndLowersTheWorstCase) {
  const std::vector<KnownPerson> people{{{arm_of(0.6), arm_of(1.0)}, {}}, {{arm_of(1.4)}, {}}};
  const auto sut = choose_impedance(people, kBand, kSlow, {});
  EXPECT_LT(sut.worst, 0.9);
  EXPECT_LE(sut.effort, 1.5);
  EXPECT_GE(sut.passive_hz, 10.0);
  // More effort allowed is never worse.
  const ImpedanceBounds strong{.most_effort = 3.0};
  const auto stronger = choose_impedance(people, kBand, kSlow, {}, {}, strong);
  EXPECT_LT(stronger.worst, sut.worst);
  EXPECT_GT(stronger.effort, 1.5);
}

// By hand: at 0 Hz the force for the wanted motion grows by (K + K_+)/K.
TEST(ChooseImpedanceTest, EffortIsTheStiffnessesRatioAtRest) {
  const admittance::ArmValues arm = arm_of(1.0);
  ImpedanceBounds only_spring;
  only_spring.most_damping = 0.0;
  only_spring.most_mass = 0.0;
  only_spring.passive_to_hz = 0.0;
  const auto sut = choose_impedance({{{arm}, {}}}, kBand, {{0.01, 1.0}}, {}, {}, only_spring);
  const double own = admittance::arm_response(arm, 0.01).impedance.real();
  EXPECT_NEAR(sut.effort, 1.0 + sut.impedance.stiffness_n_m / own, 0.01);
  EXPECT_GT(sut.impedance.stiffness_n_m, 0.0);
}

// A spring behind a delay T gives energy from the lowest frequency on where K T exceeds the stick's
// own damping, and none below it otherwise: Re(K exp(-sT)/s) = -K sin(wT)/w.
TEST(PassiveTest, ASpringNeedsTheSticksDamping) {
  const LoopTiming timing{.delay_s = 0.002, .lag_s = 0.0};
  EXPECT_LT(passive_up_to_hz({.stiffness_n_m = 300.0}, {}, timing), 0.2);
  EXPECT_EQ(passive_up_to_hz({.stiffness_n_m = 200.0}, {}, timing), 100.0);
}

// A damper behind a filter is passive up to where filter and delay turn it by a quarter turn.
TEST(PassiveTest, ADamperIsPassiveUpToItsFilter) {
  const double sut = passive_up_to_hz({.damping_n_s_m = 30.0}, {});
  EXPECT_GT(sut, 15.0);
  EXPECT_LT(sut, 40.0);
}

}  // namespace
}  // namespace stillhand::study::design_test
