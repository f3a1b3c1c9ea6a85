// SPDX-License-Identifier: Apache-2.0
// summary.json: README, "summary.json".
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/study/report/output.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/study_report.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::summary_test {
namespace {

using made::kNan;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json summary_of(const StudyRecord& record) { return json::parse(summary_json(record)); }

TEST(SummaryTest, HasEveryKeyOfItsShape) {
  StudyRecord record = made::record_of(made::random_results(4, "ABC", 71));
  record.options.seed = 9'007'199'254'740'993;  // 2^53 + 1: no double
  record.options.protocol.trial_s = 60.0;
  const json sut = summary_of(record);
  for (const char* condition : {"A", "B", "C"}) {
    for (const char* metric :
         {"rms_error_mm", "dwell_ratio", "crossover_hz", "crossover_reference_hz"}) {
      const json& sample = sut.at("conditions").at(condition).at(metric);
      EXPECT_TRUE(sample.at("mean").is_number());
      EXPECT_TRUE(sample.at("std").is_number());
      EXPECT_EQ(sample.at("per_subject").size(), 4u);
    }
  }
  for (const char* pair : {"A-B", "B-C"}) {
    for (const char* metric : {"rms_error_mm", "dwell_ratio", "crossover_hz"}) {
      const double p = sut.at("t_tests").at(pair).at(metric);
      EXPECT_GE(p, 0.0);
      EXPECT_LE(p, 1.0);
      EXPECT_EQ(sut.at("t_test_details").at(pair).at(metric).at("degrees_of_freedom"), 3.0);
    }
  }
  EXPECT_TRUE(sut.at("manova").contains("condition"));
  EXPECT_TRUE(sut.at("manova").at("interaction").is_null());
  EXPECT_TRUE(sut.at("manova_thirds").at("interaction").is_object());
  for (const char* metric : {"rms_error", "dwell_ratio", "crossover"}) {
    EXPECT_TRUE(sut.at("restoration").at(metric).is_number());
  }
  EXPECT_EQ(sut.at("seed"), 9'007'199'254'740'993u);
  EXPECT_EQ(sut.at("subjects"), 4);
  EXPECT_EQ(sut.at("trial_seconds"), 60.0);
}

TEST(SummaryTest, SimulatedSubjectsArePersonsInNoFile) {
  StudyRecord record = made::record_of(made::random_results(3, "ABC", 71));
  EXPECT_EQ(summary_of(record).at("operator"), "simulated");
  record.recorded.emplace();
  record.recorded->participants = {"P01", "P02", "P03"};
  EXPECT_EQ(summary_of(record).at("operator"), "person");
  record.recorded->simulated = {"P01"};
  EXPECT_EQ(summary_of(record).at("operator"), "simulated and person");
  record.recorded->simulated = {"P01", "P02", "P03"};
  EXPECT_EQ(summary_of(record).at("operator"), "simulated");
  const std::string page = study_report(record, {}).html();
  EXPECT_THAT(page, HasSubstr("no person took part"));
  EXPECT_THAT(page, Not(HasSubstr("Recorded participants")));
  EXPECT_THAT(participant_page(record, "P02", {}).html(), HasSubstr("no person took part"));
}

TEST(SummaryTest, AnUnfinishedExperimentIsStatedFirst) {
  StudyRecord record = made::record_of(made::random_results(1, "ABC", 71));
  record.recorded.emplace();
  record.recorded->participants = {"P01"};
  Registered& registered = record.recorded->registered.emplace();
  experiment::Standing& standing = registered.registration.standing;
  standing.complete = {"P01"};
  standing.excluded = {{"P02", "felt sick"}};
  standing.incomplete = {{"P03", "not begun"}};
  standing.openings = {{.kind = experiment::EntryKind::kUnblinded,
                        .time = "2026-11-27T00:00:00Z",
                        .text = "the grant ends",
                        .complete = 1}};
  const std::string page = study_report(record, {}).html();
  const std::size_t state = page.find(
      "This experiment is not finished. 1 of 3 participants complete; 1 excluded: P02 (felt sick); "
      "1 not complete: P03 (not begun). All conditions were unblinded at 2026-11-27T00:00:00Z, "
      "with 1 of 3 participants complete: the grant ends.");
  EXPECT_LT(state, page.find("<dl>"));
  // One participant has no interval, no deviation and no test: no column and no table for them.
  EXPECT_THAT(page, HasSubstr("No planned comparison can be tested"));
  EXPECT_THAT(page, Not(HasSubstr("change [95 % CI]")));
  EXPECT_THAT(page, HasSubstr("(no interval)"));
  const json found = summary_of(record).at("registered").at("standing");
  EXPECT_EQ(found.at("planned"), 3);
  EXPECT_EQ(found.at("incomplete").at("P03"), "not begun");
  EXPECT_EQ(found.at("unblinded").at(0).at("reason"), "the grant ends");
}

TEST(SummaryTest, EveryNumberIsReadBackBitForBit) {
  const StudyRecord record = made::record_of(made::random_results(5, "ABC", 72));
  const json sut = summary_of(record);
  const json& b = sut.at("conditions").at("B").at("rms_error_mm");
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(b.at("per_subject")[i].get<double>(),
              record.results[i].trials.at(kB).metrics.rms_error_mm);
  }
  EXPECT_EQ(b.at("mean").get<double>(), record.analysis.conditions.at(kB)[0].mean);
  EXPECT_EQ(sut.at("restoration").at("dwell_ratio").get<double>(),
            record.analysis.restoration.at(kC)[1].share.value());
}

TEST(SummaryTest, AValueThatCouldNotBeComputedIsNullAndKeepsItsPlace) {
  auto results = made::random_results(3, "ABC", 73);
  results[1].trials[kB].metrics.crossover_hz = kNan;
  const json sut = summary_of(made::record_of(results));
  const json& crossover = sut.at("conditions").at("B").at("crossover_hz");
  EXPECT_TRUE(crossover.at("per_subject")[0].is_number());
  EXPECT_TRUE(crossover.at("per_subject")[1].is_null());
  EXPECT_TRUE(crossover.at("mean").is_number());
  EXPECT_TRUE(sut.at("t_tests").at("A-B").at("crossover_hz").is_null());
  EXPECT_FALSE(sut.at("t_test_details").at("A-B").contains("crossover_hz"));
  EXPECT_TRUE(sut.at("manova").at("reason").is_string());
}

TEST(SummaryTest, AConditionWithoutAnyCrossoverHasANullMean) {
  auto results = made::random_results(2, "AB", 74);
  for (SubjectResult& result : results) result.trials[kB].metrics.crossover_hz = kNan;
  const json sut = summary_of(made::record_of(results));
  EXPECT_TRUE(sut.at("conditions").at("B").at("crossover_hz").at("mean").is_null());
  EXPECT_TRUE(sut.at("conditions").at("B").at("crossover_hz").at("std").is_null());
  EXPECT_TRUE(sut.at("restoration").at("crossover").is_null());
}

TEST(SummaryTest, OneSubjectHasNoDeviationAndNoTest) {
  const json sut = summary_of(made::record_of(made::random_results(1, "ABC", 75)));
  EXPECT_TRUE(sut.at("conditions").at("A").at("rms_error_mm").at("std").is_null());
  EXPECT_TRUE(sut.at("t_tests").at("B-C").at("dwell_ratio").is_null());
}

TEST(SummaryTest, OnlyConditionCHasACancelledShare) {
  const json sut =
      summary_of(made::record_of(made::random_results(3, "ABCD", 76))).at("conditions");
  EXPECT_TRUE(sut.at("C").contains("cancelled_share"));
  for (const char* other : {"A", "B", "D"}) EXPECT_FALSE(sut.at(other).contains("cancelled_share"));
}

TEST(SummaryTest, AWrongModelIsNamedByItsOwner) {
  auto results = made::random_results(2, "ABC", 77);
  for (SubjectResult& result : results) {
    result.trials[kB].metrics.rms_error_mm = 50.0;
    result.trials[kC].metrics.rms_error_mm = 30.0;
    result.wrong['O'] = made::trial_of(45.0, 0.3, 0.2);
    result.wrong['M'] = made::trial_of(35.0, 0.4, 0.2);
  }
  results[1].trials[kC].metrics.rms_error_mm = 50.0;
  const json sut = summary_of(made::record_of(results)).at("wrong_models");
  EXPECT_DOUBLE_EQ(sut.at("other_subject").at("surviving_share")[0].get<double>(), 0.25);
  EXPECT_DOUBLE_EQ(sut.at("mean_of_others").at("surviving_share")[0].get<double>(), 0.75);
  EXPECT_TRUE(sut.at("mean_of_others").at("surviving_share")[1].is_null());
  EXPECT_EQ(sut.at("other_subject").at("rms_error_mm").at("mean").get<double>(), 45.0);
}

TEST(SummaryTest, ARefinedModelInUseHasItsReason) {
  auto results = made::random_results(2, "A", 78);
  results[1].identification.paper_unusable = "a \"pole\" beyond\nthe circle";
  const json sut = summary_of(made::record_of(results)).at("identification");
  EXPECT_EQ(sut.at("refined_used"), 1);
  EXPECT_FALSE(sut.at("subjects")[0].at("refined_used").get<bool>());
  EXPECT_TRUE(sut.at("subjects")[0].at("reason").is_null());
  EXPECT_TRUE(sut.at("subjects")[1].at("refined_used").get<bool>());
  EXPECT_EQ(sut.at("subjects")[1].at("reason"), "a \"pole\" beyond\nthe circle");
  EXPECT_TRUE(sut.at("subjects")[1].at("refined_heldout_vaf_percent").is_null());
}

// sum c / sum d: Eq. ID-1 at 0 Hz.
TEST(SummaryTest, TheGainAtZeroHertzIsTheQuotientOfTheSums) {
  const auto results = made::random_results(1, "A", 79);
  const signal::DifferenceModel& model = results[0].identification.refined.model;
  double above = 0.0;
  double below = 0.0;
  for (const double c : model.numerator) above += c;
  for (const double d : model.denominator) below += d;
  const json sut = summary_of(made::record_of(results)).at("identification").at("subjects")[0];
  EXPECT_NEAR(sut.at("gain_at_0_hz_n_s2_m").get<double>(), std::abs(above / below),
              1e-13 * std::abs(above / below));
}

}  // namespace
}  // namespace stillhand::study::summary_test
