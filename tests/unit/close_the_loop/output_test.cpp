// SPDX-License-Identifier: Apache-2.0
// What the loop writes: verdict, summary and truth, from a result that is made up.
#include "apps/close_the_loop/output.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "services/files/rig/sealed_file.hpp"

namespace stillhand::close_the_loop::output_test {
namespace {

using nlohmann::json;

TrialRun trial(const char* label, double rms_mm, double dwell, double crossover_hz) {
  TrialRun run;
  run.label = label;
  run.metrics.rms_error_mm = rms_mm;
  run.metrics.dwell_ratio = dwell;
  run.metrics.crossover_hz = crossover_hz;
  run.metrics.crossover_reference_hz = 0.5;
  run.cancelled_share = 0.75;
  run.counterforce_delay_s = 0.004;
  run.forces = {1.5, 0.75, 6.0, 3.0};
  return run;
}

Finding finding(const char* kind, const char* channel) {
  return {kind, channel, "body", 0.5, 2.0, 1.0, "it is there"};
}

LoopRecord loop_record() {
  LoopRecord record;
  LoopResult& result = record.result;
  result.paper_model.fit = {50.0, {1.0, 2.0}, {1.0, -0.5}};
  result.trials = {trial("I", 0.0, 0.0, 0.0), trial("A", 4.0, 0.5, 0.25),
                   trial("B", 10.0, 0.25, 0.125), trial("C", 7.0, 0.375, 0.1875),
                   trial("C'", 6.25, 0.40625, 0.1875)};
  Round round;
  round.trial = trial("C+", 5.5, 0.4375, 0.25);
  round.trial.weights = {{1.0, 0.0}, {0.9, -0.1}};
  round.verdict.findings = {finding("coulomb_friction", "omega"), finding("tone", "")};
  round.verdict.control.treatments = {{"tone", true, "a law"}, {"drift", false, "no law"}};
  round.verdict.body.noise_floor.rmse = 0.5;
  round.verdict.body.final_error.rmse = 1.0;
  round.augmented = true;
  round.better = true;
  round.outcome = "kept";
  result.rounds = {round};
  record.conditions = own_trials(result);
  record.decision = decide(record.conditions, result);
  return record;
}

json summary_of(const LoopRecord& record) { return json::parse(summary_json(record)); }

TEST(OutputTest, AVerdictIsItsStrongestFinding) {
  LoopRecord record = loop_record();
  const json sut = json::parse(verdict_json(record.result.verdict()));
  EXPECT_EQ(sut["kind"], "coulomb_friction");
  EXPECT_EQ(sut["channel"], "omega");
  ASSERT_EQ(sut["findings"].size(), 2u);
  EXPECT_EQ(sut["findings"][0]["explained_rms_n"], 0.5);
  EXPECT_EQ(sut["findings"][0]["heldout_rmse_before"], 2.0);
  EXPECT_EQ(sut["findings"][0]["heldout_rmse_after"], 1.0);
  EXPECT_TRUE(sut["findings"][1]["channel"].is_null());
  EXPECT_EQ(sut["where"], "body");
  EXPECT_EQ(sut["conclusion"], "effects found");
  record.result.rounds[0].verdict.findings.clear();
  const json none = json::parse(verdict_json(record.result.verdict()));
  EXPECT_EQ(none["kind"], "none");
  EXPECT_TRUE(none["channel"].is_null());
  EXPECT_TRUE(none["where"].is_null());
  EXPECT_EQ(none["conclusion"], "nothing missing");
  EXPECT_TRUE(none["findings"].empty());
}

TEST(OutputTest, TheSummaryHasEveryConditionAndItsRestoration) {
  const json sut = summary_of(loop_record());
  ASSERT_EQ(sut["conditions"].size(), 5u);
  EXPECT_EQ(sut["conditions"]["B"]["rms_error_mm"]["mean"], 10.0);
  EXPECT_EQ(sut["conditions"]["C+"]["rms_error_mm"]["per_subject"], json({5.5}));
  EXPECT_EQ(sut["conditions"]["B"]["force_left_n"]["mean"], 1.5);
  EXPECT_EQ(sut["conditions"]["C'"]["hand_acceleration_m_s2"]["mean"], 0.75);
  EXPECT_EQ(sut["conditions"]["C"]["motor_force_n"]["mean"], 6.0);
  EXPECT_EQ(sut["conditions"]["A"]["volitional_force_n"]["mean"], 3.0);
  // (B - X)/(B - A), dyadic numbers, exact.
  EXPECT_EQ(sut["restoration"]["rms_error"], 0.5);
  EXPECT_EQ(sut["restoration"]["dwell_ratio"], 0.5);
  EXPECT_EQ(sut["restoration_c_prime"]["rms_error"], 0.625);
  EXPECT_EQ(sut["restoration_c_plus"]["rms_error"], 0.75);
  EXPECT_EQ(sut["restoration_c_plus"]["crossover"], 1.0);
  EXPECT_EQ(sut["paired"]["C-C'"]["rms_error_mm"]["mean_difference"], -0.75);
  EXPECT_EQ(sut["paired"]["C'-C+"]["rms_error_mm"]["mean_difference"], -0.75);
  EXPECT_EQ(sut["verdict"], json::parse(verdict_json(loop_record().result.verdict())));
  EXPECT_EQ(sut["force_prediction"]["after_over_noise"], 2.0);
  EXPECT_EQ(sut["identification"]["order"], 1);
}

TEST(OutputTest, WhatIsLeftHasItsCausesWhereEveryTrialKnowsThem) {
  LoopRecord record = loop_record();
  session::ForceBudget budget;
  budget.left = {2.0, 1.5, 2.5};
  budget.lateness = {0.25, 0.125, 0.375};
  for (TrialRun& trial : record.result.trials) trial.budget = budget;
  EXPECT_FALSE(causes_table(record.result));  // C+ has none
  EXPECT_TRUE(summary_of(record)["lateness"]["C+"].is_null());
  EXPECT_EQ(summary_of(record)["lateness"]["C"]["lateness"]["force_n"], 0.25);
  record.result.rounds[0].trial.budget = budget;
  const auto sut = causes_table(record.result);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->header.size(), 4u);
  EXPECT_EQ(sut->rows.at(1).at(3).text, "0.25 (0.12 to 0.38)");
  EXPECT_EQ(sut->rows.back().at(1).text, "2.00 (1.50 to 2.50)");
}

// A and B run with the motor off.
TEST(OutputTest, OnlyTrialsThatCancelHaveAShareAndADelay) {
  const json sut = summary_of(loop_record())["conditions"];
  for (const char* label : {"A", "B"}) {
    EXPECT_TRUE(sut[label]["cancelled_share"].is_null()) << label;
    EXPECT_FALSE(sut[label].contains("counterforce_delay_ms")) << label;
  }
  for (const char* label : {"C", "C'", "C+"}) {
    EXPECT_EQ(sut[label]["cancelled_share"], 0.75) << label;
    EXPECT_EQ(sut[label]["counterforce_delay_ms"], 4.0) << label;
  }
}

TEST(OutputTest, WhatCouldNotBeComputedIsNull) {
  LoopRecord record = loop_record();
  record.result.trials[2].metrics.crossover_hz = std::numeric_limits<double>::quiet_NaN();
  // Where the motion costs nothing, there is nothing to restore.
  record.result.trials[1].metrics.rms_error_mm = 10.0;
  record.conditions = own_trials(record.result);
  const json sut = summary_of(record);
  EXPECT_TRUE(sut["conditions"]["B"]["crossover_hz"]["mean"].is_null());
  EXPECT_TRUE(sut["restoration"]["crossover"].is_null());
  EXPECT_TRUE(sut["restoration"]["rms_error"].is_null());
  EXPECT_EQ(sut["restoration"]["dwell_ratio"], 0.5);
}

TEST(OutputTest, ARoundShowsItsLastWeightsAndWhatItDid) {
  LoopRecord record = loop_record();
  const json sut = summary_of(record)["rounds"][0];
  EXPECT_EQ(sut["weights"], json({0.9, -0.1}));
  EXPECT_EQ(sut["treatments"][0]["cancelled"], true);
  EXPECT_EQ(sut["treatments"][0]["how"], "a law");
  EXPECT_EQ(sut["treatments"][1]["cancelled"], false);
  EXPECT_TRUE(sut["latency"].is_null());
  // A model that did not run cancelled nothing.
  record.result.rounds[0].augmented = false;
  record.result.rounds[0].trial.weights.clear();
  record.result.rounds[0].verdict.latency = Latency{0.03, 0.002, 1.0, 0.5};
  const json without = summary_of(record)["rounds"][0];
  EXPECT_TRUE(without["weights"].is_null());
  EXPECT_EQ(without["treatments"][0]["cancelled"], false);
  EXPECT_EQ(without["treatments"][0]["how"], "kept") << "the outcome says why";
  EXPECT_EQ(without["latency"]["motor_path_s"], 0.03);
  EXPECT_EQ(without["latency"]["load_cell_s"], 0.002);
}

TEST(OutputTest, TheBestRoundSpeaksForTheLoop) {
  LoopRecord record = loop_record();
  record.result.rounds.push_back(record.result.rounds[0]);
  record.result.rounds[1].trial.metrics.rms_error_mm = 4.75;
  record.result.rounds[1].verdict.findings = {finding("delay", "")};
  record.result.final_round = 1;
  record.conditions = own_trials(record.result);
  const json sut = summary_of(record);
  EXPECT_EQ(sut["conditions"]["C+"]["rms_error_mm"]["mean"], 4.75);
  EXPECT_EQ(sut["verdict"]["kind"], "delay");
  EXPECT_EQ(sut["rounds"].size(), 2u);
}

TEST(OutputTest, AVerdictIsRightWhenItNamesKindChannelAndPlace) {
  LoopRecord sut = loop_record();
  EXPECT_FALSE(sut.right()) << "nothing was sealed";
  EXPECT_TRUE(summary_of(sut)["truth"].is_null());
  Finding& strongest = sut.result.rounds[0].verdict.findings[0];
  strongest.where = kDrive;
  sut.truth = Truth{"tone", "omega", "drive", "", 0.0, {}};
  EXPECT_FALSE(sut.right()) << "another kind";
  sut.truth->kind = "coulomb_friction";
  EXPECT_TRUE(sut.right());
  const json truth = summary_of(sut)["truth"];
  EXPECT_EQ(truth["verdict_right"], true);
  EXPECT_EQ(truth["channel"], "omega");
  EXPECT_EQ(truth["place"], "drive");
  strongest.channel = "theta";
  EXPECT_FALSE(sut.right()) << "another channel";
  strongest.channel = "omega";
  strongest.where = kBody;
  EXPECT_FALSE(sut.right()) << "another place";
  sut.truth->place = "shoulder";
  EXPECT_TRUE(sut.right()) << "a part of the body";
}

TEST(OutputTest, AnEffectOutsideOfTheKindsIsBestLeftUnexplained) {
  LoopRecord sut = loop_record();
  sut.result.rounds[0].verdict.body.detection_limit = 0.375;
  sut.truth = Truth{"delayed_reflex", "", "shoulder", "", 1.0, {}};
  EXPECT_FALSE(sut.right()) << "a kind of the catalogue is named";
  const std::string named = sut.result.rounds[0].verdict.findings[0].kind;
  sut.result.rounds[0].verdict.findings[0].kind = "free_form";
  EXPECT_TRUE(sut.right()) << "a shape without a name is right";
  sut.result.rounds[0].verdict.findings[0].kind = named;
  EXPECT_EQ(summary_of(sut)["truth"]["detectable_n"], 0.375);
  sut.result.rounds[0].verdict.findings.clear();
  EXPECT_FALSE(sut.right()) << "large enough to be seen";
  sut.truth->force_n = 0.374;
  EXPECT_TRUE(sut.right());
  sut.truth->beyond_linear_n = 0.376;
  EXPECT_FALSE(sut.right());
  sut.truth->force_n = 3.0;
  sut.truth->beyond_linear_n = 0.3;
  EXPECT_TRUE(sut.right()) << "a linear model contains the rest";
  sut.truth->place = "drive";
  sut.result.rounds[0].verdict.drive.emplace();
  sut.result.rounds[0].verdict.drive->options.least_force_n = 0.2;
  EXPECT_FALSE(sut.right()) << "0.2 N are enough in the drive";
  EXPECT_FALSE((Truth{"tone", "", "hand", "", 0.0, {}}).outside());
  EXPECT_FALSE((Truth{"none", "", "", "", 0.0, {}}).outside());
}

TEST(OutputTest, WithoutAnEffectEveryFindingIsAFalseAlarm) {
  LoopRecord sut = loop_record();
  sut.truth = Truth{"none", "", "", "", 0.0, {}};
  EXPECT_FALSE(sut.right());
  sut.result.rounds[0].verdict.findings.clear();
  EXPECT_TRUE(sut.right());
}

// 1.5 N of force left in each condition of `made`: C+ leaves no less.
TEST(OutputTest, WhetherCPlusIsKeptIsDecidedOnceForTheWholeSummary) {
  LoopRecord sut = loop_record();
  json summary = summary_of(sut);
  EXPECT_EQ(summary["kept"], false);
  EXPECT_EQ(summary["decided_on"], "motor");
  EXPECT_EQ(summary["decision"]["measure"], "force_left_n");
  EXPECT_EQ(summary["decision"]["C-C+"]["mean_difference"], 0.0);
  EXPECT_EQ(summary["rounds"][0]["kept"], false);
  EXPECT_EQ(summary["rounds"][0]["tracks_better"], true);
  EXPECT_NE(kept_text(sut).find("not kept"), std::string::npos);
  sut.conditions.at("C+")[0].forces.left_n = 1.25;
  sut.decision = decide(sut.conditions, sut.result);
  summary = summary_of(sut);
  EXPECT_EQ(summary["kept"], true);
  EXPECT_EQ(summary["decision"]["C-C+"]["mean_difference"], -0.25);
  EXPECT_EQ(summary["decision"]["model_of"], "C+");
  EXPECT_EQ(summary["rounds"][0]["kept"], true);
  EXPECT_EQ(kept_text(sut).find("not kept"), std::string::npos);
}

TEST(OutputTest, AFindingThatDoesNotCountIsNotTheVerdict) {
  LoopRecord record = loop_record();
  auto& findings = record.result.rounds[0].verdict.findings;
  findings = {finding("tone", "")};
  findings[0].counts = false;
  findings[0].explained_n = 0.0625;
  findings[0].interval95 = {0.03125, 0.09375};
  const json sut = json::parse(verdict_json(record.result.verdict()));
  EXPECT_EQ(sut["kind"], "none");
  EXPECT_EQ(sut["conclusion"], "nothing missing");
  ASSERT_EQ(sut["findings"].size(), 1u);
  EXPECT_EQ(sut["findings"][0]["counts"], false);
  EXPECT_EQ(sut["findings"][0]["force_n"]["value"], 0.0625);
  EXPECT_EQ(sut["findings"][0]["force_n"]["ci95"], json({0.03125, 0.09375}));
}

TEST(OutputTest, TheSealedTextIsReadBack) {
  rig::OpenedEffect effect;
  effect.seed = 7;
  effect.kind = "dead_zone";
  effect.channel = "theta";
  effect.place = "stick";
  effect.parameters = {{"half_width", "m", 0.25},
                       {"ratio", "-", 3.0},
                       {"force_rms", "N", 0.5},
                       {"force_beyond_linear", "N", 0.2}};
  const Truth sut = truth_of(rig::sealed_text(effect, "00ff"));
  EXPECT_EQ(sut.kind, "dead_zone");
  EXPECT_EQ(sut.channel, "theta");
  EXPECT_EQ(sut.place, "stick");
  EXPECT_EQ(sut.numbers, "force_beyond_linear 0.2 N, force_rms 0.5 N, half_width 0.25 m, ratio 3");
  EXPECT_EQ(sut.force_n, 0.5);
  EXPECT_EQ(sut.beyond_linear_n, 0.2);
  const Truth none = truth_of(rig::sealed_text({}, "00ff"));
  EXPECT_EQ(none.kind, "none");
  EXPECT_EQ(none.channel, "");
  EXPECT_EQ(none.numbers, "");
}

TEST(OutputTest, EveryFileIsNamedOnceAndIsNoPath) {
  const auto names = every_name();
  const std::set<std::string> sut(names.begin(), names.end());
  EXPECT_EQ(sut.size(), names.size());
  for (const char* name : {"report.html", "summary.json", kVerdictFile, kControlModelFile,
                           rig::kSealedFile, rig::kCommitmentFile}) {
    EXPECT_TRUE(sut.contains(name)) << name;
  }
  for (const std::string& name : names) EXPECT_EQ(name.find('/'), std::string::npos) << name;
}

}  // namespace
}  // namespace stillhand::close_the_loop::output_test
