// SPDX-License-Identifier: Apache-2.0
// Fields that a script reads from the verdict, and the same for people.
#include "apps/diagnose/diagnosis_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnose::diagnosis_json_test {

using diagnosis::Effect;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

diagnosis::Diagnosis diagnosis_with(const std::vector<Effect>& effects) {
  diagnosis::Diagnosis diagnosis;
  diagnosis.options.inputs = {"a_y", "a_x"};
  diagnosis.options.output = "f";
  diagnosis.model_class = "arx";
  diagnosis.output_unit = "N";
  diagnosis.sample_rate_hz = 128.0;
  diagnosis.model.rate_hz = 128.0;
  diagnosis.model.inputs = {"a_y", "a_x"};
  diagnosis.model.body.numerators = {{1.0, 0.5}, {0.25, 0.125}};
  diagnosis.model.body.denominator = {1.0, -0.5};
  diagnosis.model.body.offset = 0.75;
  diagnosis.baseline.model = diagnosis.model;
  diagnosis.baseline_error = {2.0, 1.5, 2.5, 80.0};
  diagnosis.final_error = {1.0, 0.5, 1.5, 95.0};
  diagnosis.noise_floor = {0.5, 0.25, 0.75, "repeats", {{"repeats", 0.5}}};
  for (const Effect& effect : effects) {
    diagnosis::FoundEffect found;
    found.effect = effect;
    found.before = {2.0, 1.5, 2.5, 80.0};
    found.after = {1.0, 0.5, 1.5, 95.0};
    found.p = 1e-9;
    found.evidence = "it is there";
    diagnosis.effects.push_back(found);
  }
  diagnosis.model.effects = effects;
  return diagnosis;
}

json json_of(const diagnosis::Diagnosis& diagnosis) {
  return json::parse(diagnosis_json(diagnosis));
}

TEST(DiagnosisJsonTest, ErrorsAndTheBodyAreGivenAsTheyAre) {
  const json sut = json_of(diagnosis_with({}));
  EXPECT_EQ(sut["input"], "a_y,a_x");
  EXPECT_EQ(sut["output"], "f");
  EXPECT_EQ(sut["sample_rate_hz"], 128.0);
  EXPECT_EQ(sut["baseline"]["order"], 1);
  EXPECT_EQ(sut["baseline"]["heldout_rmse"], 2.0);
  EXPECT_EQ(sut["baseline"]["ci95"], json({1.5, 2.5}));
  EXPECT_EQ(sut["final"]["heldout_rmse"], 1.0);
  EXPECT_EQ(sut["final"]["ci95"], json({0.5, 1.5}));
  EXPECT_EQ(sut["noise_floor_rmse"], 0.5);
  EXPECT_EQ(sut["noise_floor"]["low"], 0.25);
  EXPECT_EQ(sut["body"]["numerators"]["a_x"], json({0.25, 0.125}));
  EXPECT_EQ(sut["body"]["denominator"], json({1.0, -0.5}));
  EXPECT_EQ(sut["body"]["offset"], 0.75);
  EXPECT_TRUE(sut["effects"].empty());
  EXPECT_TRUE(sut["unexplained"].is_null());
}

TEST(DiagnosisJsonTest, AnEffectIsCarriedNotCarriedOrCarriedInPart) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({diagnosis::made::every_effect().front(),
                                                   diagnosis::made::every_effect().back(),
                                                   diagnosis::made::every_effect().front()});
  diagnosis.carried_error = {1.25, 1.0, 1.5, 90.0};
  diagnosis.effects[0].carried = 1.0;
  diagnosis.effects[1].carried = 0.25;
  diagnosis.effects[2].why_not_carried = "the inputs do not determine it";
  const json sut = json_of(diagnosis);
  EXPECT_EQ(sut["carried"]["heldout_rmse"], 1.25);
  EXPECT_EQ(sut["effects"][0]["carried"], true);
  EXPECT_TRUE(sut["effects"][0]["why_not_carried"].is_null());
  EXPECT_EQ(sut["effects"][1]["carried"], 0.25);
  EXPECT_EQ(sut["effects"][2]["carried"], false);
  EXPECT_EQ(sut["effects"][2]["why_not_carried"], "the inputs do not determine it");
}

TEST(DiagnosisJsonTest, AnEffectHasItsForceInNewtonsAndWhetherItCounts) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({diagnosis::made::every_effect().front()});
  diagnosis.effects[0].explained = {0.5, 0.25, 0.75};
  json sut = json_of(diagnosis);
  EXPECT_EQ(sut["effects"][0]["force_n"]["value"], 0.5);
  EXPECT_EQ(sut["effects"][0]["force_n"]["ci95"], json({0.25, 0.75}));
  EXPECT_EQ(sut["effects"][0]["counts"], true);
  EXPECT_EQ(sut["least_force_n"], diagnosis::kLeastForce_n);
  EXPECT_EQ(sut["verdict"], "effects found");

  diagnosis.effects[0].counts = false;
  sut = json_of(diagnosis);
  EXPECT_EQ(sut["effects"][0]["counts"], false);
  EXPECT_EQ(sut["verdict"], "nothing missing");
  EXPECT_THAT(diagnosis_table(diagnosis),
              AllOf(HasSubstr("nothing missing"), HasSubstr("too small to count"),
                    HasSubstr("does not count")));

  diagnosis.output_unit = "V";
  diagnosis.effects[0].counts = true;
  sut = json_of(diagnosis);
  EXPECT_TRUE(sut["effects"][0]["force_n"].is_null());
  EXPECT_EQ(sut["least_force_n"], 0.0);
}

TEST(DiagnosisJsonTest, EveryKindCanBeWritten) {
  const auto effects = diagnosis::made::every_effect();
  const json sut = json_of(diagnosis_with(effects));
  ASSERT_EQ(sut["effects"].size(), effects.size());
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const json& written = sut["effects"][i];
    EXPECT_EQ(written["kind"], effects[i].kind);
    EXPECT_EQ(written["form"], effects[i].form);
    EXPECT_EQ(written["signals"], json(effects[i].channels));
  }
}

TEST(DiagnosisJsonTest, ASizeHasItsStandardErrorAndUnit) {
  diagnosis::Diagnosis diagnosis =
      diagnosis_with({{"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.1, 0, 1}}, {0.5}}});
  diagnosis::Size gain{"gain", "N/(m/s^2)", 0.5, "at 0 Hz"};
  gain.std_error = 0.25;
  diagnosis.effects[0].sizes = {gain, {"magnitude", "N/(m/s^2)", 0.375, "", 1.5}};
  const json sut = json_of(diagnosis)["effects"][0]["parameters"];
  ASSERT_EQ(sut.size(), 2u);
  EXPECT_EQ(
      sut["gain"],
      json({{"value", 0.5}, {"std_error", 0.25}, {"unit", "N/(m/s^2)"}, {"meaning", "at 0 Hz"}}));
  EXPECT_EQ(sut["magnitude"]["at_hz"], 1.5);
  EXPECT_TRUE(sut["magnitude"]["std_error"].is_null()) << "it is not known";
  EXPECT_THAT(diagnosis_table(diagnosis), AllOf(HasSubstr("gain 0.5 +- 0.25 N/(m/s^2)"),
                                                HasSubstr("magnitude 0.375 N/(m/s^2) at 1.5 Hz")));
}

TEST(DiagnosisJsonTest, AnEffectHasAChannelOrNull) {
  diagnosis::Diagnosis diagnosis =
      diagnosis_with({{"drift", "linear", {}, {}, {1.0}}, {"drift", "linear", {}, {}, {1.0}}});
  diagnosis.effects[1].channel = "theta";
  const json sut = json_of(diagnosis);
  EXPECT_TRUE(sut["effects"][0]["channel"].is_null());
  EXPECT_EQ(sut["effects"][1]["channel"], "theta");
  EXPECT_EQ(sut["effects"][0]["heldout_rmse_before"], 2.0);
  EXPECT_EQ(sut["effects"][0]["heldout_rmse_after"], 1.0);
  EXPECT_EQ(sut["effects"][0]["ci95"], json({0.5, 1.5}));
  EXPECT_EQ(sut["effects"][0]["p"], 1e-9);
}

TEST(DiagnosisJsonTest, WhatWasNotComputedIsNull) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({});
  diagnosis.baseline.impulse_response_rmse = std::numeric_limits<double>::quiet_NaN();
  diagnosis.baseline.equation_error_rmse = std::numeric_limits<double>::infinity();
  const json sut = json_of(diagnosis);
  EXPECT_TRUE(sut["baseline"]["impulse_response_rmse"].is_null());
  EXPECT_TRUE(sut["baseline"]["equation_error_rmse"].is_null());
}

TEST(DiagnosisJsonTest, WhatIsUnexplainedSaysWhereToLook) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({});
  diagnosis.unexplained = diagnosis::Unexplained{"something", {0.5, 3.0}, {7.0, 9.0}, {"theta"}};
  const json sut = json_of(diagnosis);
  EXPECT_EQ(sut["unexplained"]["what"], "something");
  EXPECT_EQ(sut["unexplained"]["band_hz"], json({0.5, 3.0}));
  EXPECT_EQ(sut["unexplained"]["times_s"], json({7.0, 9.0}));
  EXPECT_EQ(sut["unexplained"]["channels"], json({"theta"}));
  EXPECT_THAT(diagnosis_table(diagnosis), HasSubstr("something"));
}

TEST(DiagnosisJsonTest, NamesThatNeedEscapesComeBack) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({});
  diagnosis.notes = {"file \"ride\\1\".csv\n\tµ"};
  EXPECT_EQ(json_of(diagnosis)["notes"][0], diagnosis.notes[0]);
}

TEST(DiagnosisJsonTest, AVerdictSaysHowOftenItsBlocksGiveTheName) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({diagnosis::made::every_effect().front()});
  EXPECT_TRUE(json_of(diagnosis)["drawn_names"].is_null());
  diagnosis.drawn_names = {100, {{"hysteresis", 83}, {"dead_zone", 17}}};
  EXPECT_EQ(json_of(diagnosis)["drawn_names"],
            json::parse(R"({"hysteresis":0.83,"dead_zone":0.17})"));
  EXPECT_THAT(diagnosis_table(diagnosis),
              HasSubstr("draws         Of 100 draws of the recording's blocks, hysteresis is named "
                        "in 83, dead zone in 17\n"));
}

TEST(DiagnosisJsonTest, ASharePerVerdictIsGivenWhereItWasAskedFor) {
  diagnosis::Diagnosis diagnosis = diagnosis_with({});
  EXPECT_TRUE(json_of(diagnosis)["stability"].is_null());
  diagnosis.stability = {4, {{"hysteresis", 3}, {"nothing missing", 1}}};
  EXPECT_EQ(json_of(diagnosis)["stability"],
            json::parse(R"({"hysteresis":0.75,"nothing missing":0.25})"));
  EXPECT_THAT(diagnosis_table(diagnosis),
              HasSubstr("4 repetitions without a fifth of the recording end in hysteresis (3), "
                        "nothing missing (1)"));
}

TEST(DiagnosisJsonTest, TheTableHasALineForEveryError) {
  const std::string bare = diagnosis_table(diagnosis_with({}));
  EXPECT_THAT(bare, AllOf(HasSubstr("a_y,a_x"), HasSubstr("order 1"), HasSubstr("128 Hz"),
                          HasSubstr("VAF 80.00 %"), HasSubstr("VAF 95.00 %"),
                          HasSubstr("0.5 N (0.25 to 0.75)"), Not(HasSubstr("effect 1"))));
  diagnosis::Diagnosis diagnosis =
      diagnosis_with({{"coulomb_friction", "sign", {"omega"}, {}, {1.0}}});
  diagnosis.effects[0].channel = "omega";
  EXPECT_THAT(diagnosis_table(diagnosis),
              AllOf(HasSubstr("effect 1"), HasSubstr("coulomb_friction (omega): 2 -> 1 N"),
                    HasSubstr("it is there")));
}

}  // namespace stillhand::diagnose::diagnosis_json_test
