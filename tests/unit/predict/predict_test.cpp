// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/predict.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "services/files/diagnosis/model_file.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::predict::predict_test {
namespace {

using diagnosis::Body;
using diagnosis::Effect;
using diagnosis::Measurement;
using diagnosis::Model;
using testing::AllOf;
using testing::DoubleNear;
using testing::HasSubstr;
using testing::Pointwise;
using testing::StartsWith;
namespace made = diagnosis::made;

// Sums of a few terms near 1 in a body that forgets within 30 samples: 1e-16 times a few hundred.
constexpr double kRounding = 1e-13;

Prediction predict(const Model& model, const Measurement& measurement) {
  return stillhand::predict::predict(diagnosis::carried_as_it_is(model), measurement);
}

const std::vector<double>& values_of(const Prediction& prediction) {
  return prediction.table.columns.at(0).values;
}

Model static_model(double gain, double offset = 0.0) {
  Model model = made::model_of({{{gain}}, {1.0}, offset});
  return model;
}

std::vector<double> ramp(std::size_t count) {
  std::vector<double> u(count);
  for (std::size_t n = 0; n < count; ++n) u[n] = 0.01 * static_cast<double>(n);
  return u;
}

// The past of Eq. DG-60 and the signal, which swings about 0 at 100 Hz: its beginning in reverse
// fades before it within 100 samples.
std::vector<double> with_past(const std::vector<double>& u) {
  std::vector<double> out(u.size() - 1, 0.0);
  for (std::size_t n = 1; n < 100; ++n) {
    out[u.size() - 1 - n] =
        u[n] * (0.5 + 0.5 * std::cos(std::numbers::pi * 0.01 * static_cast<double>(n)));
  }
  out.insert(out.end(), u.begin(), u.end());
  return out;
}

// 1/(1 + 0.99 q^-1) rings at half the rate and forgets in 100 samples.  A cosine that began with a
// jump would ring with half its amplitude; after the past it answers 1/1.99 at once.
TEST(PredictTest, AModeNearHalfTheRateDoesNotRingAtTheStart) {
  std::vector<double> u;
  for (int n = 0; n < 2000; ++n) u.push_back(std::cos(0.03 * n));
  const Prediction sut = predict(made::model_of({{{1.0, 0.0}}, {1.0, 0.99}, 0.0}),
                                 made::measurement_of({{"u", "V", u}}));
  for (std::size_t n = 0; n < 100; ++n) EXPECT_NEAR(values_of(sut)[n], u[n] / 1.99, 0.01) << n;
}

TEST(PredictTest, IsTheDifferenceEquationAfterItsFadedPast) {
  const auto u = made::white(400, 1);
  const Prediction sut =
      predict(made::model_of(made::two_pole_body()), made::measurement_of({{"u", "V", u}}));
  const Body body = made::two_pole_body();
  std::vector<double> expected =
      made::settled_answer(body.numerators[0], body.denominator, with_past(u));
  expected.erase(expected.begin(), expected.end() - 400);
  EXPECT_THAT(values_of(sut), Pointwise(DoubleNear(kRounding), expected));
  EXPECT_EQ(sut.table.columns[0].name, "y_model");
  EXPECT_EQ(sut.table.columns[0].unit, "N");
  EXPECT_DOUBLE_EQ(sut.table.time_s[399], 3.99);
  EXPECT_TRUE(sut.notes.empty());
}

TEST(PredictTest, AMeasuredOutputHasNoSay) {
  const auto u = made::white(300, 2);
  const Model model = made::model_of(made::four_pole_body());
  const auto without = predict(model, made::measurement_of({{"u", "V", u}}));
  const auto with =
      predict(model, made::measurement_of({{"y", "N", made::white(300, 3)}, {"u", "V", u}}));
  EXPECT_EQ(values_of(without), values_of(with));
}

TEST(PredictTest, EveryStretchStartsByItself) {
  const auto u = made::white(500, 4);
  const Model model = made::model_of(made::two_pole_body());
  const Prediction sut =
      predict(model, made::cut_in_two(made::measurement_of({{"u", "V", u}}), 200, 3.0));
  const Prediction second = predict(
      model, made::measurement_of({{"u", "V", std::vector<double>(u.begin() + 200, u.end())}}));
  ASSERT_EQ(values_of(sut).size(), 500u);
  for (std::size_t n = 0; n < 300; ++n) {
    ASSERT_EQ(values_of(sut)[200 + n], values_of(second)[n]) << n;
  }
  EXPECT_DOUBLE_EQ(sut.table.time_s[200], 5.0);
}

// A filled-in sample drives the body as the others do; it only has no row.
TEST(PredictTest, AFilledInSampleHasNoRow) {
  const auto u = made::white(300, 5);
  Measurement measurement = made::measurement_of({{"u", "V", u}});
  const Model model = made::model_of(made::two_pole_body());
  const auto whole = values_of(predict(model, measurement));
  measurement.weight[100] = measurement.weight[101] = 0.0;
  const Prediction sut = predict(model, measurement);
  ASSERT_EQ(sut.table.row_count(), 298u);
  EXPECT_DOUBLE_EQ(sut.table.time_s[99], 0.99);
  EXPECT_DOUBLE_EQ(sut.table.time_s[100], 1.02);
  EXPECT_EQ(values_of(sut)[99], whole[99]);
  EXPECT_EQ(values_of(sut)[100], whole[102]);
}

// Linear without an offset: the answer to a sum is the sum of the answers, up to the body's size
// of about 10 times rounding.
TEST(PredictTest, TheAnswerToASumIsTheSumOfTheAnswers) {
  const Model model = made::model_of(made::four_pole_body());
  for (std::uint64_t seed = 10; seed < 20; ++seed) {
    const auto u = made::white(200, seed);
    const auto v = made::white(200, seed + 100);
    std::vector<double> both(200);
    for (std::size_t n = 0; n < 200; ++n) both[n] = 3.0 * u[n] - v[n];
    const auto to = [&](const std::vector<double>& input) {
      return values_of(predict(model, made::measurement_of({{"u", "V", input}})));
    };
    const auto of_u = to(u);
    const auto of_v = to(v);
    const auto of_both = to(both);
    for (std::size_t n = 0; n < 200; ++n) {
      ASSERT_NEAR(of_both[n], 3.0 * of_u[n] - of_v[n], 1e-11) << "seed " << seed << ", n = " << n;
    }
  }
}

TEST(PredictTest, AModelFromItsFileAnswersBitForBit) {
  Model model =
      made::model_of(made::four_pole_body(), {{"coupled_input", "static", {"v"}, {}, {1.0 / 3.0}}});
  model.body.offset = 0.1;
  const Model again = diagnosis::parse_model(diagnosis::model_json(model), "model.json");
  const Measurement measurement =
      made::measurement_of({{"u", "V", made::white(200, 6)}, {"v", "V", made::white(200, 7)}});
  EXPECT_EQ(values_of(predict(model, measurement)), values_of(predict(again, measurement)));
}

TEST(PredictTest, WhatTheModelCannotBeRunOnIsRefusedWithItsReason) {
  Model other_input = made::model_of(made::two_pole_body());
  other_input.inputs = {"elbow"};
  const auto with = [](const Effect& effect) {
    return made::model_of(made::two_pole_body(), {effect});
  };
  const std::pair<Model, testing::Matcher<std::string>> cases[]{
      {other_input, HasSubstr("elbow")},
      {with({"coupled_input", "static", {"grip"}, {}, {1.0}}),
       HasSubstr("effect 'coupled_input': got no channel 'grip' among u, ")},
      {with({"delay", "of the input", {}, {}, {}}), StartsWith("model: got ")}};
  for (const auto& each : cases) {
    EXPECT_THAT(support::refusal([&] {
                  predict(each.first, made::measurement_of({{"u", "V", made::white(100, 8)}}));
                }),
                each.second);
  }
}

TEST(PredictTest, AnInputInAnotherUnitThanTheModelsIsRefused) {
  diagnosis::CarriedModel carried =
      diagnosis::carried_as_it_is(made::model_of(made::two_pole_body()));
  carried.inputs = {{"u", "m/s^2", -1.0, 1.0}};
  EXPECT_THAT(support::refusal([&] {
                (void)stillhand::predict::predict(
                    carried, made::measurement_of({{"u", "g", made::white(100, 8)}}));
              }),
              HasSubstr("input 'u': got values in [g], want [m/s^2]"));
}

TEST(PredictTest, ARateThatIsNoMultipleOfTheModelsIsRefusedWithBoth) {
  for (const double rate_hz : {50.0, 99.0, 150.0, 1005.0}) {
    const std::string message = support::refusal([&] {
      predict(static_model(1.0), made::measurement_of({{"u", "V", ramp(3000)}}, rate_hz));
    });
    EXPECT_THAT(message, AllOf(StartsWith("made: got "), HasSubstr("100 Hz"))) << rate_hz;
  }
}

TEST(PredictTest, InputsOnWhichTheModelRunsAwayAreRefused) {
  Body body;
  body.denominator = {1.0, -1.5};
  body.numerators = {{1.0, 0.0}};
  EXPECT_THAT(support::refusal([&] {
                predict(made::model_of(body), made::measurement_of({{"u", "V", ramp(2000)}}));
              }),
              StartsWith("made: got "));
}

TEST(PredictTest, AnEffectOfTimeAloneIsLeftOutWithANote) {
  const Measurement measurement = made::measurement_of({{"u", "V", made::white(300, 10)}});
  const auto plain = predict(made::model_of(made::two_pole_body()), measurement);
  const Effect tone{
      "tone", "beside the body", {}, {{"frequency", "Hz", 3.0, 2.0, 4.0}}, {1.0, 1.0}};
  const Effect drift{"drift", "linear", {}, {}, {5.0}};
  const Effect gain{"time_varying_gain", "linear", {}, {{"change", "-", 0.4, -1.0, 1.0}}, {}};
  const Prediction sut =
      predict(made::model_of(made::two_pole_body(), {tone, drift, gain}), measurement);
  EXPECT_EQ(values_of(sut), values_of(plain));
  EXPECT_THAT(sut.notes,
              testing::ElementsAre(StartsWith("tone"), StartsWith("drift"),
                                   AllOf(StartsWith("time_varying_gain"), HasSubstr("mean"))));
}

TEST(PredictTest, TheReadersNotesComeFirst) {
  Measurement measurement = made::measurement_of({{"u", "V", made::white(300, 11)}});
  measurement.notes = {"3 gaps filled in."};
  const Effect drift{"drift", "linear", {}, {}, {5.0}};
  const Prediction sut = predict(made::model_of(made::two_pole_body(), {drift}), measurement);
  EXPECT_THAT(sut.notes, testing::ElementsAre("3 gaps filled in.", StartsWith("drift")));
}

// A 1 Hz sine at 1 kHz through a gain at 100 Hz and back.  The cubic's error: its tangents are
// central differences, off by w^3 T^2 / 6, and have a weight of at most 0.0962 T:
// 0.016 (2 pi 0.01)^3 = 4.0e-6 of an amplitude of 2.5.  The low-pass at 40 Hz takes less than 1e-9
// off, and half a second from either end its transient has fallen below e^-24.
TEST(PredictTest, ATenTimesFasterRecordingIsAnsweredAtItsOwnRate) {
  std::vector<double> u(4007);
  for (std::size_t n = 0; n < u.size(); ++n) {
    u[n] = std::sin(2.0 * std::numbers::pi * 0.001 * static_cast<double>(n));
  }
  const Prediction sut =
      predict(static_model(2.5, -1.0), made::measurement_of({{"u", "V", u}}, 1000.0));
  ASSERT_EQ(values_of(sut).size(), u.size());
  for (std::size_t n = 500; n + 500 < u.size(); ++n) {
    ASSERT_NEAR(values_of(sut)[n], 2.5 * u[n] - 1.0, 1.1e-5) << n;
  }
  EXPECT_DOUBLE_EQ(sut.table.time_s.back(), 4.006);
}

Measurement in_stretches(const std::vector<std::size_t>& lengths, const std::vector<double>& u) {
  Measurement measurement = made::measurement_of({{"u", "V", u}}, 1000.0);
  measurement.stretches.clear();
  std::size_t first = 0;
  for (const std::size_t length : lengths) {
    const double start_s = static_cast<double>(first) / 1000.0 +
                           2.0 * static_cast<double>(measurement.stretches.size());
    measurement.stretches.push_back({first, first + length, start_s});
    first += length;
  }
  return measurement;
}

// Four rows between two gaps are less than one sample of a model at 100 Hz.
TEST(PredictTest, AStretchShorterThanASampleOfTheModelHasNoRowsAndTheNextOneKeepsItsOwn) {
  const auto u = ramp(1504);
  const Model model = made::model_of(made::two_pole_body());
  const Prediction sut = predict(model, in_stretches({500, 4, 1000}, u));
  ASSERT_EQ(sut.table.row_count(), 1500u);
  const Prediction last =
      predict(model, in_stretches({1000}, std::vector<double>(u.begin() + 504, u.end())));
  for (std::size_t n = 0; n < 1000; ++n) {
    ASSERT_EQ(values_of(sut)[500 + n], values_of(last)[n]) << n;
  }
  EXPECT_DOUBLE_EQ(sut.table.time_s[499], 0.499);
  EXPECT_DOUBLE_EQ(sut.table.time_s[500], 4.504);
  EXPECT_THAT(sut.notes, testing::ElementsAre(StartsWith("4 ")));
}

TEST(PredictTest, ARecordingOfShortStretchesAloneIsRefused) {
  const Measurement measurement = in_stretches({9, 4, 7}, ramp(20));
  EXPECT_THAT(support::refusal([&] { predict(static_model(1.0), measurement); }),
              AllOf(StartsWith("made: got "), HasSubstr("10 samples")));
}

}  // namespace
}  // namespace stillhand::predict::predict_test
