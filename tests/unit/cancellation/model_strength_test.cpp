// SPDX-License-Identifier: Apache-2.0
// Each bound of Eq. CC-14 from both sides, 60 N s^2/m and 10 N, by models whose gain has a closed
// form.
#include "services/core/cancellation/model_strength.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "services/core/contract/units.hpp"

namespace stillhand::cancellation::model_strength_test {
namespace {

using signal::HysteresisOperator;

Refusal refusal_of(const ControlModel& model) {
  return check_strength(model, signal::poles(path_model(model, model.inputs[0])), {60.0, 10.0});
}
ControlModel still() { return control_model({1000.0, {0.0, 0.0}, {1.0, 0.0}}); }
ControlModel with_path(const DirectPath& path) {
  ControlModel model = still();
  model.paths = {path};
  return model;
}

TEST(SlopesOfTest, AreThoseOfEachLineOfTheMapAndOfItsMemory) {
  const auto expect = [](const Slopes& sut, double least, double most) {
    EXPECT_DOUBLE_EQ(sut.least, least);
    EXPECT_DOUBLE_EQ(sut.most, most);
  };
  const ValueMap map{-1.0, 5.0, {3.0, -3.0, 1.0, 2.0}};  // lines of 2: -3, 2, 0.5
  expect(slopes_of(ValueMap{}), 1.0, 1.0);
  expect(slopes_of(map), -3.0, 2.0);
  expect(slopes_of(map, nullptr), -3.0, 2.0);
  // Eq. CC-14: 0, and those of phi times 1 (stop) or 2 (Dahl) over the threshold.
  const Hysteresis stop{{}, HysteresisOperator::kStop, 0.5, -1.0, 1.0};
  const Hysteresis dahl{{}, HysteresisOperator::kDahl, 0.5, -1.0, 1.0};
  expect(slopes_of(map, &stop), -6.0, 4.0);
  expect(slopes_of(map, &dahl), -12.0, 8.0);
  expect(slopes_of({0.0, 1.0, {0.0, 3.0}}, &stop), 0.0, 6.0);
  expect(slopes_of({0.0, 1.0, {0.0, -3.0}}, &stop), -6.0, 0.0);
  EXPECT_DOUBLE_EQ(slopes_of(map).steepest(), 3.0);
}

// A sum or a difference of two taps is largest at 0 or at 500 Hz, and there alone within 1e-5.
TEST(ModelStrengthTest, TheGainIsBoundedFromZeroToHalfTheRate) {
  for (const double sign : {1.0, -1.0}) {
    for (const double tap : {29.9999, 30.0001}) {
      EXPECT_EQ(refusal_of(control_model({1000.0, {tap, sign * tap}, {1.0, 0.0}})),
                tap < 30.0 ? Refusal::kNone : Refusal::kGain)
          << sign << " " << tap;
    }
  }
  EXPECT_EQ(refusal_of(control_model({1000.0, {60.0}, {1.0}})), Refusal::kNone) << "the bound";
}

// Knots at -0.5, 0, 0.5 and 1 rad; the channel ends at 0.6 rad.
TEST(ModelStrengthTest, AMapFromTheStickCountsByItsLargestValueInReach) {
  const auto refusal = [](const std::vector<double>& values, double gain) {
    return refusal_of(with_path({Channel::kTheta, 0.0, {-0.5, 1.0, values}, gain}));
  };
  EXPECT_EQ(refusal({0.0, 0.0, 5.0, 0.0}, 1.99), Refusal::kNone);  // 5 at a knot, 4 at the end
  EXPECT_EQ(refusal({0.0, 0.0, 5.0, 0.0}, -2.01), Refusal::kPath);
  EXPECT_EQ(refusal({0.0, 0.0, 0.0, 50.0}, 0.99), Refusal::kNone);  // 10 at the end, 50 beyond it
  EXPECT_EQ(refusal({0.0, 0.0, 0.0, -50.0}, 1.01), Refusal::kPath);
}

// A path from the platform counts by its steepest slope, and with a memory by its largest value
// within w = +-1.
TEST(ModelStrengthTest, APathFromThePlatformCountsByItsSlopeUnlessItHasAMemory) {
  const ValueMap steep{-2.0, 2.0, {0.0, 0.0, 65.0, 0.0, 0.0}};  // 0 at the channel's ends
  DirectPath path{Channel::kAccelX, 0.0, steep, 0.92};
  EXPECT_EQ(refusal_of(with_path(path)), Refusal::kNone);
  path.gain = 0.93;
  EXPECT_EQ(refusal_of(with_path(path)), Refusal::kPath);
  for (const double threshold : {1e-3, 1.0}) {
    path.gain = 0.15;  // 9.75 N at w = 0
    ControlModel model = with_path(path);
    model.hysteresis = {{0, HysteresisOperator::kStop, threshold, -1.0, 1.0}};
    EXPECT_EQ(refusal_of(model), Refusal::kNone);
    model.paths[0].gain = 0.16;
    EXPECT_EQ(refusal_of(model), Refusal::kPath);
  }
  // Roll tips gravity over: 60 g.
  EXPECT_EQ(refusal_of(with_path({Channel::kRoll, 0.0, {}, 59.99 * kGravity_m_s2})),
            Refusal::kNone);
  EXPECT_EQ(refusal_of(with_path({Channel::kRoll, 0.0, {}, -60.01 * kGravity_m_s2})),
            Refusal::kPath);
}

// The spring's |E(1)/A(1) phi(w)| times the slope of what is behind it, |gain map(w)| of a path and
// hypot of a wave, all together.
TEST(ModelStrengthTest, WhatActsAtRestAddsUpToTheBoundAndNoFurther) {
  ControlModel model = still();
  for (const double cosine_n : {8.0, 8.0001}) {
    model.waves = {{{}, 5.0, 6.0, -cosine_n}};
    EXPECT_EQ(refusal_of(model), cosine_n == 8.0 ? Refusal::kNone : Refusal::kPath) << cosine_n;
  }
  model.denominator = {1.0, -0.5};
  model.loop = LoopPath{{0.0, -0.4}, {}, {}, {-2.0, 2.0, {-5.0, 5.0}}};
  model.hysteresis = {{{}, HysteresisOperator::kStop, 1.0, -1.0, 1.0},
                      {0, HysteresisOperator::kStop, 1.0, -1.0, 1.0}};
  model.output = {-1.0, 1.0, {-1.5, 1.5}};
  model.paths = {{Channel::kTheta, 0.0, {}, -3.0}};
  for (const double wave_n : {3.9999, 4.0001}) {  // 0.4/0.5 2.5 1.5 + 3 + 4 = 10
    model.waves = {{{}, 5.0, wave_n, 0.0}};
    EXPECT_EQ(refusal_of(model), wave_n < 4.0 ? Refusal::kNone : Refusal::kPath) << wave_n;
  }
}

// Inputs of one channel add up with their maps' slopes and the output's: 2 (3 5 + 4) = 38 and 22.
TEST(ModelStrengthTest, GainsOfOneChannelAddUpWithTheirSlopes) {
  for (const double path : {21.999, 22.001}) {
    ControlModel model = still();
    model.output = {-1.0, 1.0, {2.0, -2.0}};
    model.inputs = {{Channel::kAccelY, {-1.0, 1.0, {-3.0, 3.0}}, {5.0, 0.0}},
                    {Channel::kAccelY, {}, {-4.0, 0.0}}};
    model.paths = {{Channel::kAccelY, 0.0, {}, path}};
    EXPECT_EQ(refusal_of(model), path < 22.0 ? Refusal::kNone : Refusal::kGain) << path;
    model.paths[0].channel = Channel::kAccelZ;
    EXPECT_EQ(refusal_of(model), Refusal::kNone);
  }
}

}  // namespace
}  // namespace stillhand::cancellation::model_strength_test
