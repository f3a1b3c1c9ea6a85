// SPDX-License-Identifier: Apache-2.0
// What a recording is predicted with: levels before it, ranges, and what is left out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "apps/predict/predict.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::predict::carried_prediction_test {
namespace {

using diagnosis::Body;
using diagnosis::CarriedModel;
using diagnosis::Effect;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
namespace made = diagnosis::made;

// 23 degrees and a ride on top, through poles of the body with a gain of 40: from rest the first
// samples would be off by 920 N.
TEST(CarriedPredictionTest, ASlowPathOnAnOffsetMakesNoTransient) {
  const Body body = made::two_pole_body();
  double at_rest = 0.0;
  for (const double c : body.denominator) at_rest += c;
  const Effect through{
      "coupled_input", "through the body", {"temp"}, {}, {40.0 * at_rest, 0.0, 0.0}};
  std::vector<double> temp(600, 23.0);
  for (std::size_t n = 0; n < temp.size(); ++n) temp[n] += 0.001 * static_cast<double>(n);
  const Prediction sut = predict(
      diagnosis::carried_as_it_is(made::model_of(body, {through})),
      made::measurement_of({{"u", "V", std::vector<double>(600, 0.0)}, {"temp", "degC", temp}}));
  for (std::size_t n = 0; n < 600; ++n) {
    // 40 N/K times how far 0.1 K/s runs within the body's memory of 0.1 s and the first second.
    ASSERT_NEAR(sut.table.columns[0].values[n], 40.0 * temp[n], 5.0) << n;
  }
}

TEST(CarriedPredictionTest, WhatWasLeftOutAndWhatIsHeldIsNoted) {
  CarriedModel carried = diagnosis::carried_as_it_is(
      made::model_of(made::two_pole_body(), {{"coupled_input", "static", {"v"}, {}, {2.0}}}));
  carried.model.effects[0].seen.push_back({"v", "V", -1.0, 1.0});
  carried.inputs.push_back({"u", "V", -9.0, 9.0});
  carried.left_out.push_back({{"drift", "linear", {}, {}, {}}, "the inputs do not determine it"});
  carried.stability = diagnosis::Stability::kTested;
  std::vector<double> v(400, 0.5);
  for (std::size_t n = 300; n < 400; ++n) v[n] = 7.0;
  const std::vector<double> u(400, 0.0);
  const Prediction sut = predict(carried, made::measurement_of({{"u", "V", u}, {"v", "V", v}}));
  EXPECT_NEAR(sut.table.columns[0].values[200], 1.0, 1e-12);
  EXPECT_NEAR(sut.table.columns[0].values[350], 3.0, 1e-12) << "held at 1.5 V";
  EXPECT_THAT(sut.notes, testing::ElementsAre(
                             "drift: left out, because the inputs do not determine it",
                             HasSubstr("not proved"),
                             AllOf(StartsWith("coupled_input: v leaves"), HasSubstr("-1 to 1 V"),
                                   HasSubstr("-1.5"), HasSubstr("1.5"))));
}

// 3 Hz where 0.5 to 2 Hz were seen.
TEST(CarriedPredictionTest, MotionAtFrequenciesThatWereNotSeenIsNoted) {
  CarriedModel carried = diagnosis::carried_as_it_is(made::model_of(made::two_pole_body()));
  carried.bands.push_back({"u", 0.5, 2.0});
  const auto notes_at = [&](double frequency_hz) {
    std::vector<double> u(2000);
    for (std::size_t n = 0; n < u.size(); ++n) {
      u[n] = std::sin(2.0 * std::numbers::pi * frequency_hz * 0.01 * static_cast<double>(n));
    }
    return predict(carried, made::measurement_of({{"u", "V", u}})).notes;
  };
  EXPECT_THAT(notes_at(1.0), testing::IsEmpty());
  EXPECT_THAT(notes_at(3.0), testing::ElementsAre(
                                 AllOf(HasSubstr("of the power of u"), HasSubstr("0.5 to 2 Hz"))));
}

}  // namespace
}  // namespace stillhand::predict::carried_prediction_test
