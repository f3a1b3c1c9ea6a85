// SPDX-License-Identifier: Apache-2.0
// An effect is held a quarter of its range beyond where it was seen, Eq. DG-56.
#include "services/core/diagnosis/model/seen_range.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::seen_range_test {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Pointwise;
using testing::SizeIs;

constexpr std::size_t kCount = 1001;

// u and v swing once between -1 and 1 in `scale`, v about 20.
Signals signals_of(double scale) {
  std::vector<double> u(kCount);
  std::vector<double> v(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    u[n] = scale * std::sin(0.01 * static_cast<double>(n) * 2.0 * std::numbers::pi);
    v[n] = 20.0 + u[n];
  }
  return {
      made::measurement_of({{"u", "V", u}, {"v", "degC", v}, {"y", "N", made::white(kCount, 1)}}),
      {"u"},
      "y"};
}

Model model_with(Effect effect) {
  return made::model_of({{{1.0}}, {1.0}, 0.0}, {std::move(effect)});
}

std::vector<double> run_of(const Model& model, double scale) {
  return free_run(model, signals_of(scale)).prediction;
}

const Effect kPath{"coupled_input", "static", {"v"}, {}, {2.0}};
const Effect kBent{
    "nonlinear_stiffness", "at the output", {}, {{"cubic", "1/N^2", 0.1, 0.0, 1.0}}, {}};
const Effect kLimit{"input_saturation", "hard", {"u"}, {{"limit", "V", 0.5, 0.0, 9.0}}, {}};

TEST(SeenRangeTest, ItIsTheRangeOfWhatTheEffectReads) {
  for (const Effect& effect : {kPath, kBent, kLimit}) {
    Model sut = model_with(effect);
    note_seen(sut, signals_of(1.0));
    ASSERT_THAT(sut.effects[0].seen, SizeIs(1)) << effect.kind;
    const SeenRange& range = sut.effects[0].seen[0];
    const double middle = effect.kind == "coupled_input" ? 20.0 : 0.0;
    EXPECT_NEAR(range.low, middle - 1.0, 2e-3) << effect.kind;
    EXPECT_NEAR(range.high, middle + 1.0, 2e-3) << effect.kind;
  }
}

TEST(SeenRangeTest, WithinItNothingChanges) {
  for (const Effect& effect : {kPath, kBent, kLimit}) {
    const Model model = model_with(effect);
    Model sut = model;
    note_seen(sut, signals_of(1.0));
    EXPECT_EQ(run_of(sut, 1.0), run_of(model, 1.0)) << effect.kind;
    // A quarter of 2 V on each side, but for the last digit.
    EXPECT_EQ(run_of(sut, 1.49), run_of(model, 1.49)) << effect.kind;
  }
}

TEST(SeenRangeTest, ATermIsHeldAtItsEdge) {
  Model sut = model_with(kPath);
  note_seen(sut, signals_of(1.0));
  const Signals far = signals_of(3.0);
  std::vector<double> want(kCount);
  for (std::size_t n = 0; n < kCount; ++n) {
    const double v = far.at("v").values[n];
    want[n] = far.at("u").values[n] + 2.0 * std::clamp(v, 18.5, 21.5);
  }
  // The range's own edges lie between samples of the sine.
  EXPECT_THAT(run_of(sut, 3.0), Pointwise(DoubleNear(0.01), want));
}

TEST(SeenRangeTest, AMapGoesOnStraight) {
  Model sut = model_with(kBent);
  note_seen(sut, signals_of(1.0));
  const auto held = run_of(sut, 4.0);
  // y + 0.1 y^3 at 1.5, and from there to 4 a slope of 1, as its tangent is steeper: 1.675.
  EXPECT_NEAR(*std::ranges::max_element(held), 1.5 + 0.1 * 3.375 + 2.5, 0.02);
  Model limited = model_with(kLimit);
  note_seen(limited, signals_of(1.0));
  const auto far = run_of(limited, 4.0);
  EXPECT_DOUBLE_EQ(*std::ranges::max_element(far), 0.5) << "a limit stays one";
  // u^2, seen to -1.5; sample 75 has u = -4.  The tangent's slope, -3, is held to -1: 2.25 + 2.5.
  Model square = model_with(
      made::effect_of("asymmetry", "square at the input", {"u"},
                      {{"square_share", "-", 1.0, -2.0, 2.0}, constant("largest", "V", 1.0)}));
  note_seen(square, signals_of(1.0));
  EXPECT_NEAR(run_of(square, 4.0)[75], 2.25 + 2.5, 1e-9);
}

// Of the output with a cube: 2 N seen, then 20 N; phi is that of 3 N for ever.
TEST(SeenRangeTest, ASpringsForceIsHeld) {
  Body body = made::two_pole_body();
  const Effect spring = made::effect_of("nonlinear_stiffness", "cubic of the output", {},
                                        {{"threshold", "N", 10.0, 0.1, 90.0}}, {-0.02, 0.0});
  Model sut = made::model_of(body, {spring});
  note_seen(sut, signals_of(1.0));
  const SeenRange& range = sut.effects[0].seen.at(0);
  const FreeRun run = free_run(sut, signals_of(10.0));
  const double most = std::pow(range.upper_edge() / 10.0, 3);
  EXPECT_GT(*std::ranges::max_element(run.argument), 1.2 * range.upper_edge());
  EXPECT_NEAR(*std::ranges::max_element(run.phi), most, 1e-12);
}

TEST(SeenRangeTest, WhatARecordingLeavesIsReportedWithItsShare) {
  Model model = model_with(kPath);
  note_seen(model, signals_of(1.0));
  const auto left_at = [&](double scale) {
    const Signals signals = signals_of(scale);
    return left_ranges(model, input_ranges(signals_of(1.0)), signals, free_run(model, signals));
  };
  EXPECT_THAT(left_at(1.0), testing::IsEmpty()) << "no recording leaves its own range";
  const auto sut = left_at(2.0);
  ASSERT_THAT(sut, SizeIs(2));
  EXPECT_EQ(sut[0].effect, "") << "the body's input";
  EXPECT_EQ(sut[1].effect, "coupled_input");
  EXPECT_EQ(sut[1].range.of, "v");
  // |sin| above a half: two thirds of the time.
  EXPECT_NEAR(sut[1].share, 2.0 / 3.0, 0.02);
}

}  // namespace stillhand::diagnosis::seen_range_test
