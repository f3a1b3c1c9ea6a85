// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/part_list.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation::part_list_test {

const Part kPredicted{PartKind::kPredictedSignal, {1.394, 11.18, 1136.0, 0.1}};
const Part kSpring{PartKind::kImpedance, {400.0, 1.0, 0.0}};
constexpr auto kNoKind = static_cast<PartKind>(77);

constexpr Trial kNoTrial;

Moment moment(double accel_m_s2, double theta_rad, double predicted_n) {
  return {accel_m_s2, theta_rad, 0.0, predicted_n, 0.0, 0, kNoTrial};
}

// Eq. MI-6.  A low-pass begins with what it gets; the hand's deflection is f^/K = 11.36/1136 m.
TEST(PartListTest, WhatEachPartMovesIsTakenOffTheCommand) {
  PartList filtered({.signal = SignalConfig{{1000.0, {-0.003}, {1.0}}, {}, {}},
                     .parts = {{PartKind::kLowPass, {1.0, 0.7}}}});
  EXPECT_NEAR(filtered.off(moment(2.0, 0.2, 0.0)), -0.003 * 2.0 / 0.1, 1e-12);
  PartList predicted({.parts = {kPredicted}});
  double off_rad = 0.0;
  for (int n = 0; n < 5000; ++n) off_rad = predicted.off(moment(0.0, 0.3, 11.36));
  EXPECT_NEAR(off_rad, 0.01 / 0.1, 1e-6);  // exp(-5 s 4.0/s) is left
}

// It learns from lever theta: half the angle at twice the lever is the same, to the bit.
TEST(PartListTest, WhatIsLearntIsTheHandsMotion) {
  const auto force_n = [](double lever_m, double theta_rad) {
    PartList sut(
        {.parts = {{PartKind::kLmsForce, {0.5, 1.394, 11.18, 1136.0}}}, .lever_m = lever_m});
    double out_n = 0.0;
    for (int n = 0; n < 2000; ++n) {
      const double turn = std::sin(7e-3 * n);
      out_n = sut.forces(moment(2.0 * turn, 0.0, 0.0));
      sut.learn(theta_rad * turn, true);
    }
    return out_n;
  };
  EXPECT_NE(force_n(0.1, 0.06), 0.0);
  EXPECT_EQ(force_n(0.1, 0.06), force_n(0.2, 0.03));
}

TEST(PartListTest, AModelOfTheForceIsNeededByTheForceAndByWhatReadsIt) {
  EXPECT_TRUE(PartList({.force = true}).needs_force());
  EXPECT_TRUE(PartList({.parts = {kSpring, kPredicted}}).needs_force());
  EXPECT_FALSE(PartList({.parts = {kSpring}}).needs_force());
}

TEST(PartListTest, RefusesAModelOfOrder13AndAPartThatIsNotMadeOfValues) {
  std::vector<double> taps(13, 0.0);
  taps[0] = 1.0;
  EXPECT_NO_THROW(PartList({.signal = SignalConfig{{1000.0, taps, taps}, {}, {}}}));
  taps.push_back(0.0);
  EXPECT_THROW(PartList({.signal = SignalConfig{{1000.0, taps, taps}, {}, {}}}), ConfigError);
  EXPECT_THROW(PartList({.parts = {{PartKind::kForce}}}), ConfigError);
  EXPECT_THROW(PartList({.parts = {{kNoKind}}}), ConfigError);
}

TEST(PartTest, TheMotorOpposesTheFeedthroughUnlessAPartAnswersTheStick) {
  const std::vector<Part> force{{PartKind::kForce}};
  EXPECT_TRUE(opposes_feedthrough(force));
  EXPECT_FALSE(opposes_feedthrough({{PartKind::kForce}, kSpring}));
  EXPECT_FALSE(opposes_feedthrough({kSpring}));
  EXPECT_FALSE(opposes_feedthrough({kPredicted}));
  EXPECT_FALSE(opposes_feedthrough({{kNoKind}}));
  EXPECT_TRUE(drives_motor({kSpring}));
}

}  // namespace stillhand::cancellation::part_list_test
