// SPDX-License-Identifier: Apache-2.0
// How right a prediction is, by hand.
#include "apps/predict/judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::predict::judgement_test {
namespace {

namespace made = diagnosis::made;
using nlohmann::json;
using testing::HasSubstr;

constexpr std::size_t kSamples = 3000;

// y = 2 u + 1 + a part of 0.5 u': the linear model is 2 u, the carried one all of it.
diagnosis::Measurement measured() {
  const std::vector<double> u = made::ride(kSamples, 1);
  std::vector<double> y = u;
  for (double& value : y) value = 2.0 * value + 1.0;
  return made::measurement_of({{"u", "m/s^2", u}, {"y", "N", y}});
}

const diagnosis::Model kExact = made::model_of({{{2.0}}, {1.0}, 1.0});
const diagnosis::Model kWithoutOffset = made::model_of({{{2.0}}, {1.0}, 0.0});
const diagnosis::Model kHalf = made::model_of({{{1.0}}, {1.0}, 1.0});

Judgement judgement_of(const diagnosis::Model& carried,
                       const std::optional<diagnosis::Model>& linear) {
  Prediction prediction = predict(diagnosis::carried_as_it_is(carried), measured());
  return judged(prediction, linear, measured()).value();
}

TEST(JudgementTest, ARightModelFitsByAHundredPerCent) {
  const Score sut = judgement_of(kExact, {}).carried.score;
  EXPECT_NEAR(sut.rmse, 0.0, 1e-12);
  EXPECT_NEAR(sut.vaf_percent, 100.0, 1e-9);
  EXPECT_NEAR(sut.fit_percent, 100.0, 1e-9);
}

// An offset of 1 N is no variance; RMSE and fit see it.  y - mean y has an RMS of 2 (u has 1, up to
// its mean of a few hundredths).
TEST(JudgementTest, VarianceForgivesAnOffsetAndFitDoesNot) {
  const Score sut = judgement_of(kWithoutOffset, {}).carried.score;
  EXPECT_NEAR(sut.rmse, 1.0, 1e-12);
  EXPECT_NEAR(sut.vaf_percent, 100.0, 1e-9);
  EXPECT_NEAR(sut.fit_percent, 100.0 * (1.0 - 1.0 / 2.0), 0.5);
}

// Half of the swing is left: a quarter of the variance.
TEST(JudgementTest, HalfTheGainLeavesAQuarterOfTheVariance) {
  const Judgement sut = judgement_of(kExact, kHalf);
  ASSERT_TRUE(sut.linear.has_value());
  EXPECT_NEAR(sut.linear->score.vaf_percent, 75.0, 1e-9);
  EXPECT_NEAR(sut.linear->score.fit_percent, 50.0, 0.5);
  const std::string text = judgement_table(sut);
  EXPECT_THAT(text, testing::StartsWith("linear"));
  EXPECT_THAT(text, HasSubstr("VAF 75.00 %"));
}

TEST(JudgementTest, AnotherUnitOrSignOfTheOutputIsNotUsable) {
  for (const auto& [by, said] :
       {std::pair{1e3, "y is 1e+03 times what the model predicts: the unit"},
        std::pair{1e-3, "y is 0.001 times"}, std::pair{-1.0, "with the other sign"}}) {
    diagnosis::Measurement other = measured();
    for (double& value : other.channels[1].values) value *= by;
    Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), other);
    const Judgement sut = judged(prediction, {}, other).value();
    EXPECT_THAT(judgement_table(sut), testing::StartsWith("usable   no: "));
    EXPECT_THAT(sut.unusable, HasSubstr(said));
    EXPECT_EQ(json::parse(judgement_json(prediction, sut, {}))["usable"], false);
  }
  EXPECT_EQ(judgement_of(kHalf, {}).unusable, "");
}

// What the start leaves is off by 3 N.
TEST(JudgementTest, AScoreSaysOverHowManyRowsAndWhatTheStartShares) {
  diagnosis::Measurement other = measured();
  for (std::size_t n = 0; n < kSamples / 10; ++n) other.channels[1].values[n] += 3.0;
  Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), other);
  const Judgement sut = judged(prediction, {}, other).value();
  EXPECT_EQ(sut.carried.score.rows, kSamples);
  EXPECT_NEAR(sut.carried.score.start_rmse, 3.0, 1e-9);
  EXPECT_NEAR(sut.carried.score.rest_rmse, 0.0, 1e-9);
  EXPECT_THAT(judgement_table(sut), HasSubstr("scored   3000 rows; RMSE 3 N in the first tenth"));
  EXPECT_EQ(json::parse(judgement_json(prediction, sut, {}))["carried"]["rows"], kSamples);
}

TEST(JudgementTest, TooFewRowsAreNotScored) {
  diagnosis::Measurement few = measured();
  for (std::size_t n = kLeastScored - 1; n < kSamples; ++n) few.weight[n] = 0.0;
  Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), few);
  EXPECT_FALSE(judged(prediction, {}, few).has_value());
  EXPECT_THAT(prediction.notes.back(), HasSubstr("19 rows, and a score takes 20"));
}

TEST(JudgementTest, WithoutTheOutputThereIsNone) {
  diagnosis::Measurement inputs = measured();
  inputs.channels.pop_back();
  Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), inputs);
  EXPECT_FALSE(judged(prediction, kHalf, inputs).has_value());
  const json sut = json::parse(judgement_json(prediction, {}, {}));
  EXPECT_TRUE(sut["carried"].is_null());
  EXPECT_EQ(sut["output"], "y");
  EXPECT_EQ(sut["samples"], kSamples);
}

TEST(JudgementTest, AnotherUnitIsNotCompared) {
  diagnosis::Measurement other = measured();
  other.channels.back().unit = "kN";
  Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), other);
  EXPECT_FALSE(judged(prediction, {}, other).has_value());
  EXPECT_THAT(prediction.notes.back(), HasSubstr("kN"));
}

// Samples that were filled in have no row: 100 of them move nothing.
TEST(JudgementTest, FilledInSamplesAreNotJudged) {
  diagnosis::Measurement gap = measured();
  for (std::size_t n = 1000; n < 1100; ++n) {
    gap.weight[n] = 0.0;
    gap.channels.back().values[n] = 1e3;
  }
  Prediction prediction = predict(diagnosis::carried_as_it_is(kExact), gap);
  const Judgement sut = judged(prediction, {}, gap).value();
  EXPECT_EQ(sut.measured.values.size(), kSamples - 100);
  EXPECT_NEAR(sut.carried.score.rmse, 0.0, 1e-12);
}

TEST(JudgementTest, ThePictureShowsBothModelsAndWhatTheyLeave) {
  const report::Figure sut = judgement_figure(judgement_of(kExact, kHalf));
  ASSERT_EQ(sut.panels.size(), 2U);
  EXPECT_EQ(sut.panels[0].series.size(), 3U);
  EXPECT_EQ(sut.panels[1].series.size(), 2U);
  const auto& times_s = sut.panels[0].series[0].x;
  EXPECT_NEAR(times_s.back() - times_s.front(), 10.0, 0.02);
  for (const double left : sut.panels[1].series[1].y) ASSERT_NEAR(left, 0.0, 1e-12);
}

TEST(JudgementTest, ThePictureShowsOneModelWhereNoEffectIsSaved) {
  const report::Figure sut = judgement_figure(judgement_of(kHalf, kHalf));
  ASSERT_EQ(sut.panels[0].series.size(), 2U);
  EXPECT_THAT(sut.panels[0].series[1].label, HasSubstr("no effect is saved"));
  EXPECT_EQ(sut.panels[1].series.size(), 1U);
}

}  // namespace
}  // namespace stillhand::predict::judgement_test
