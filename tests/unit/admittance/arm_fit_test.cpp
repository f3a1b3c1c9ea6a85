// SPDX-License-Identifier: Apache-2.0
// 1 s.
#include "services/core/admittance/arm_fit.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "services/core/rig/parts/body_response.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/simulated_arm.hpp"

namespace stillhand::admittance::arm_fit_test {
namespace {

constexpr double kFitRate_hz = 250.0;

// In the order of ArmParameter: the reflex's damping is 0.125 s of its stiffness there.
ArmValues arm_of(const simulated::Values& v) {
  return {v[0], v[1], v[2], v[3],         v[4],  v[5], v[6] + 0.10,
          v[7], v[8], v[9], 0.125 * v[9], v[10], 2.2};
}

// Eqs. AD-9 to AD-11 against matrices that Eigen eliminates: rounding alone.
TEST(ArmModelTest, EqualsTheMatricesOfThreeMasses) {
  const auto drawn = simulated::drawn_arm(1, 0);
  for (const double f : {0.05, 0.5, 2.0, 7.0, 20.0}) {
    const auto truth = simulated::truth_at(drawn, f);
    const ArmResponse sut = arm_response(arm_of(drawn), f);
    const FreeStickResponse stick = free_stick(sut, {}, f);
    const auto near = [](std::complex<double> a, std::complex<double> b) {
      EXPECT_LT(std::abs(a - b), 1e-9 * std::abs(b));
    };
    near(1.0 / sut.impedance, truth.admittance);
    near(stick.stick_per_force, truth.x_per_force);
    near(stick.feedthrough_to_position, truth.x_per_accel);
    near(stick.feedthrough_to_force, truth.f_per_accel);
  }
}

// The same structure as the rig's chain: RG-6 and RG-7 in closed form.
TEST(ArmModelTest, EqualsTheRigsBodyWithoutAReflex) {
  const rig::BodyConfig body;
  const rig::StickConfig stick;
  const ArmValues arm{body.trunk_mass_kg,
                      body.seat_damping_n_s_m,
                      body.seat_stiffness_n_m,
                      body.arm_mass_kg,
                      body.shoulder_damping_n_s_m,
                      body.shoulder_stiffness_n_m,
                      body.hand_mass_kg + stick.handle_mass_kg,
                      body.grip_damping_n_s_m,
                      body.grip_stiffness_n_m,
                      0.0,
                      0.0,
                      0.04,
                      2.2};
  for (const double f : {0.05, 1.0, 3.0, 6.0, 15.0}) {
    const ArmResponse sut = arm_response(arm, f);
    const auto h = rig::feedthrough_response(body, stick, true, f);
    const auto x = rig::hand_admittance(body, stick, true, f);
    EXPECT_LT(std::abs(sut.feedthrough - h), 1e-9 * std::abs(h));
    EXPECT_LT(std::abs(free_stick(sut, {}, f).stick_per_force - x), 1e-9 * std::abs(x));
  }
}

// Errors over standard errors of 8 drawn arms.  Standard normal where Eq. AD-14 holds: of some 100
// numbers (correlated within an arm) 95 % lie within 2; 80 % is below that by 7 independent ones.
TEST(ArmFitTest, StandardErrorsCoverTheTruthAndTheStructureHolds) {
  const Excitation excitation = design({.rate_hz = kFitRate_hz});
  int within = 0;
  int all = 0;
  double misfit = 0.0;
  constexpr int kArms = 8;
  for (int i = 0; i < kArms; ++i) {
    const auto drawn = simulated::drawn_arm(3, i);
    const auto run = simulated::run(drawn, excitation, kFitRate_hz, 8, {}, 300 + i);
    const ArmFit sut = fit_arm(estimate(run.record, excitation));
    const ArmValues truth = arm_of(drawn);
    EXPECT_TRUE(sut.reflex);
    misfit += sut.misfit / kArms;
    for (const ArmParameter p : sut.fitted) {
      const double z = (sut.values[p] - truth[p]) / sut.standard_error[p];
      within += std::abs(z) < 2.0 ? 1 : 0;
      ++all;
      // Eq. AD-14: half of the value, of a gain half of its scale.
      const double scale = p == kReflexStiffness ? 100.0
                           : p == kReflexDamping ? 10.0
                                                 : sut.values[p];
      EXPECT_EQ(std::ranges::count(sut.undetermined, p), sut.standard_error[p] > 0.5 * scale) << p;
    }
    EXPECT_EQ(sut.degrees, 2 * 40 - 13);
    // What the admittance shows best.
    EXPECT_NEAR(sut.values[kGripStiffness] / truth[kGripStiffness], 1.0, 0.25);
  }
  EXPECT_GE(within, all * 80 / 100);
  EXPECT_LT(within, all);
  // chi^2 of 67 degrees, mean of 8: 1 +- 4 * sqrt(2/67/8), and half as much again for the spread of
  // the weights.
  EXPECT_NEAR(misfit, 1.0, 0.36);
}

TEST(ArmFitTest, LeavesOutAReflexThatIsNotThere) {
  const Excitation excitation = design({.rate_hz = kFitRate_hz});
  auto drawn = simulated::drawn_arm(4, 0);
  drawn[9] = 0.0;
  const auto run = simulated::run(drawn, excitation, kFitRate_hz, 8, {}, 400);
  LineEstimates lines = estimate(run.record, excitation);
  const ArmFit sut = fit_arm(lines);
  EXPECT_FALSE(sut.reflex);
  EXPECT_EQ(sut.values[kReflexStiffness], 0.0);
  EXPECT_EQ(sut.fitted.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(sut.correlation[i * 9 + i], 1.0, 1e-12);
  // 14 neighbours; the fit of the same lines with 6 is the same, but for what is known of it:
  // chi^2 (nu - 1)/nu (AD-13, AD-15), and the root of nu/(nu - 2) (AD-14).
  lines.neighbours = 6;
  const ArmFit fewer = fit_arm(lines);
  EXPECT_EQ(fewer.values, sut.values);
  EXPECT_NEAR(sut.misfit / fewer.misfit, (13.0 / 14.0) / (5.0 / 6.0), 1e-12);
  EXPECT_NEAR(sut.reflex_evidence / fewer.reflex_evidence, (13.0 / 14.0) / (5.0 / 6.0), 1e-12);
  EXPECT_NEAR(sut.standard_error[kArmMass] / fewer.standard_error[kArmMass],
              std::sqrt((14.0 / 12.0) / (6.0 / 4.0)), 1e-12);
}

// Spreads of up to a quarter leave 1.3 % of a mean over 400 people; the mean arm is rounded to two
// digits or more, 1.1 by up to 4.5 %.
TEST(ArmFitTest, TheMeanArmIsThatOfThePopulation) {
  ArmValues mean{};
  for (int i = 0; i < 400; ++i) {
    const ArmValues drawn = arm_of(simulated::drawn_arm(5, i));
    for (std::size_t p = 0; p < kReflexStiffness; ++p) mean[p] += drawn[p] / 400.0;
  }
  for (std::size_t p = 0; p < kReflexStiffness; ++p) {
    EXPECT_NEAR(mean_arm()[p] / mean[p], 1.0, 0.06) << p;
  }
}

TEST(ArmFitTest, RefusesTooFewLinesAndLinesWithoutAVariance) {
  LineEstimates sut;
  const auto said = [&] { return support::refusal([&] { fit_arm(sut); }); };
  sut.admittance.resize(20);
  EXPECT_THAT(said(), testing::HasSubstr("positive finite variance"));
  for (LineResponse& line : sut.admittance) line = {1.0, 1e-3, 1e-9};
  sut.neighbours = 2;
  EXPECT_THAT(said(), testing::HasSubstr("more than 4 lines of a record of four periods or more"));
}

}  // namespace
}  // namespace stillhand::admittance::arm_fit_test
