// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/detection_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/diagnose/diagnosis_json.hpp"

namespace stillhand::diagnose::detection_json_test {

diagnosis::DetectionResult made_result() {
  diagnosis::DetectionResult result;
  result.detections = {{"product of", "v and w", 0.2, 1e-4, true, {"v", "w"}}};
  result.coherence.independent_averages = 20.0;
  result.coherence.partial_threshold = 0.5;
  result.coherence.partial = {{"v", {0.1, 0.7}, 0.7, 3.0, 1e-5, true}};
  diagnosis::DetectionLines lines;
  lines.periodicity = {100, 500, 4, 0.001};
  lines.repeats = {0.05, 0.04, 0.06, 900.0, 4, true};
  lines.even = {{0.4}, {0.1}, {0.02}, {0.01}, 0.3, 1e-6};
  result.lines = lines;
  return result;
}

TEST(DetectionJsonTest, EveryAnswerIsThere) {
  const auto sut = detection_json(made_result());
  EXPECT_EQ(sut["questions"][0]["channels"], (nlohmann::ordered_json{"v", "w"}));
  EXPECT_EQ(sut["questions"][0]["found"], true);
  EXPECT_EQ(sut["coherence"]["partial"][0]["channel"], "v");
  EXPECT_EQ(sut["coherence"]["partial"][0]["at_hz"], 3.0);
  EXPECT_EQ(sut["lines"]["period_samples"], 500);
  EXPECT_EQ(sut["lines"]["first_period_left_out"], true);
  EXPECT_EQ(sut["lines"]["even"]["lines"], 1);
  EXPECT_EQ(sut["lines"]["even"]["p"], 1e-6);
  EXPECT_TRUE(sut["lines"]["odd"].is_null());
}

TEST(DetectionJsonTest, WithoutAPeriodAndCoherenceTheyAreNull) {
  const auto sut = detection_json({});
  EXPECT_TRUE(sut["lines"].is_null());
  EXPECT_TRUE(sut["coherence"].is_null());
  EXPECT_TRUE(sut["questions"].empty());
}

// The keys that scripts rely on stay next to the new ones.
TEST(DetectionJsonTest, TheVerdictHoldsBothResidualsAnswersAndTheirThresholds) {
  diagnosis::Diagnosis diagnosis;
  diagnosis.before = made_result();
  diagnosis.noise_floor = {0.05, 0.04, 0.06, "repeats", {{"repeats", 0.05}, {"final model", 0.07}}};
  const auto sut = nlohmann::ordered_json::parse(diagnosis_json(diagnosis));
  EXPECT_EQ(sut["detection"]["least_share"], 0.06);
  EXPECT_EQ(sut["detection"]["significance"], 0.01);
  EXPECT_FALSE(sut["detection"]["before"]["lines"].is_null());
  EXPECT_TRUE(sut["detection"]["after"]["lines"].is_null());
  EXPECT_EQ(sut["noise_floor"]["estimates"]["final model"], 0.07);
  for (const char* key : {"input", "output", "sample_rate_hz", "baseline", "noise_floor_rmse",
                          "verdict", "effects", "final", "unexplained"}) {
    EXPECT_TRUE(sut.contains(key)) << key;
  }
}

TEST(DetectionJsonTest, TheEvidenceNamesTheKindsThatTie) {
  diagnosis::Diagnosis diagnosis;
  diagnosis::FoundEffect found;
  found.effect = {"drift", "linear", {}, {}, {1.0}};
  found.evidence = "it drifts";
  found.ties = {"tone", "delay"};
  diagnosis.effects = {found};
  const auto sut = nlohmann::ordered_json::parse(diagnosis_json(diagnosis));
  EXPECT_EQ(sut["effects"][0]["evidence"], "it drifts");
}

// A note may name many recordings.
TEST(DetectionJsonTest, ALineOfTheTableIsAsLongAsItMustBe) {
  diagnosis::Diagnosis diagnosis;
  diagnosis.notes = {std::string(3000, 'x') + "end", "after it"};
  EXPECT_TRUE(diagnosis_table(diagnosis).ends_with("xend\nnote          after it\n"));
}

}  // namespace stillhand::diagnose::detection_json_test
