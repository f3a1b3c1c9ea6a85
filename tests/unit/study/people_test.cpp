// SPDX-License-Identifier: Apache-2.0
// Participants' pages, effects over people (--diagnose), Eq. SU-15 (--simulated).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/study/recorded/diagnoses.hpp"
#include "apps/study/recorded/simulated_people.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/participants.hpp"
#include "apps/study/report/report_sections.hpp"
#include "services/core/statistics/t_test.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::people_test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RecordedSource source_of(const std::vector<std::string>& codes) {
  RecordedSource out;
  for (const std::string& code : codes) {
    out.trials.push_back({code, "01", 1, 1, kA, made::trial_of(20.0, 0.5, 0.2), 0.0});
  }
  return out;
}

TEST(ParticipantFilesTest, EveryCodeHasAFileOfItsOwnInsideTheFolder) {
  const auto sut = participant_files(source_of({"P01", "P01", "a/b", "a:b", "../x", "é"}));
  EXPECT_EQ(sut.size(), 5u);
  EXPECT_EQ(sut.at("P01"), "participant_P01.html");
  EXPECT_EQ(sut.at("a/b"), "participant_a_b.html");
  EXPECT_EQ(sut.at("a:b"), "participant_a_b-2.html");
  EXPECT_EQ(sut.at("../x"), "participant____x.html");
}

TEST(RemarksOnTest, AreTheLinesOfThatCodeAlone) {
  RecordedSource source;
  source.left_out = {"P1: no complete pegged trial", "P10: excluded, ill",
                     "P1, session 01, trial 3: was ended early"};
  EXPECT_THAT(remarks_on(source, "P1"),
              ElementsAre("Left out: no complete pegged trial",
                          "Left out: session 01, trial 3: was ended early"));
  EXPECT_THAT(remarks_on(source, "P"), IsEmpty());
}

PersonDiagnosis with_findings(const std::vector<close_the_loop::Finding>& findings) {
  PersonDiagnosis out;
  out.findings = findings;
  return out;
}

TEST(RecurringTest, EffectsAreCountedByPeopleForEachKindChannelAndPlace) {
  const close_the_loop::Finding friction{"friction", "omega", "drive", 1.0, 0, 0, ""};
  const close_the_loop::Finding strong{"friction", "omega", "drive", 3.0, 0, 0, ""};
  const close_the_loop::Finding tone{"tone", "", "body", 9.0, 0, 0, ""};
  const close_the_loop::Finding elsewhere{"friction", "omega", "body", 2.0, 0, 0, ""};
  const auto sut = recurring_in({{"P01", with_findings({friction, strong})},
                                 {"P02", with_findings({strong, tone})},
                                 {"P03", with_findings({elsewhere})},
                                 {"P04", with_findings({})}});
  ASSERT_EQ(sut.size(), 3u);
  EXPECT_EQ(sut[0].where, "drive");
  EXPECT_THAT(sut[0].participants, ElementsAre("P01", "P02"));
  EXPECT_EQ(sut[0].explained_n, 2.0);  // median of 1 and 3: a person counts once
  EXPECT_EQ(sut[1].kind, "tone");      // one person each: the larger force first
  EXPECT_EQ(sut[2].where, "body");
}

class PairedChecksTest : public testing::Test {
 protected:
  const std::vector<std::string> codes_{"P01", "P02", "P03", "P04"};
  const std::vector<SubjectResult> recorded_ = made::random_results(4, "AB", 3);
};

TEST_F(PairedChecksTest, TheSamePeopleWithoutADifferenceHaveNoTest) {
  const Analysis same = analyse(recorded_);
  const auto sut = paired_checks(codes_, same, codes_, same);
  ASSERT_EQ(sut.size(), 2 * kMetricCount);
  for (const PairedCheck& check : sut) {
    EXPECT_EQ(check.mean_difference, 0.0);
    EXPECT_FALSE(check.test.has_value());
    EXPECT_EQ(check.p_signed_rank, 1.0);
  }
}

TEST_F(PairedChecksTest, PeopleAreFoundByTheirCodesAndAMissingOneHasNoSay) {
  auto made_again = recorded_;
  made_again.erase(made_again.begin() + 1);  // P02 could not be simulated
  made_again[0].trials[kB].metrics.rms_error_mm -= 1.0;
  made_again[1].trials[kB].metrics.rms_error_mm -= 2.0;
  made_again[2].trials[kB].metrics.rms_error_mm -= 6.0;
  const auto sut =
      paired_checks(codes_, analyse(recorded_), {"P01", "P03", "P04"}, analyse(made_again));
  const PairedCheck& b = sut[kMetricCount];
  EXPECT_EQ(b.condition, kB);
  EXPECT_EQ(b.n, 3u);
  EXPECT_NEAR(b.mean_difference, 3.0, 1e-12);
  ASSERT_TRUE(b.test.has_value());
  EXPECT_NEAR(b.p_signed_rank, 0.25, 1e-12);  // 2/2^3: all three have one sign
  EXPECT_EQ(*b.p_holm, b.test->p);            // the only test: Holm changes nothing
}

TEST_F(PairedChecksTest, MoreThanChanceIsWhatHolmLeavesBelowTheLevel) {
  SimulatedSide sut;
  sut.paired = {{.condition = kA, .p_holm = 0.04}, {.condition = kB, .p_holm = 0.06}, {}};
  EXPECT_EQ(sut.more_than_chance(), 1u);
}

TEST(ChanceSentenceTest, WhereNobodyWasComparedNothingIsSaidOfADifference) {
  SimulatedSide sut;
  EXPECT_THAT(chance_sentence(sut), HasSubstr("no person was both"));
  sut.paired = {{}};  // a metric that nobody has
  EXPECT_THAT(chance_sentence(sut), HasSubstr("no person was both"));
  sut.paired.push_back({.condition = kA, .n = 2});
  EXPECT_THAT(chance_sentence(sut), HasSubstr("do not differ at all"));
}

TEST(GainSentenceTest, TheIntervalHasTheSignOfTheDifference) {
  Diagnoses sut;
  sut.gain = statistics::paired_t_test(std::vector{1.0, 2.0, 3.0}, std::vector{0.6, 1.4, 2.7});
  ASSERT_TRUE(sut.gain.has_value());
  EXPECT_THAT(gain_sentence(sut), ContainsRegex("left 0.433 N \\[0\\.[0-9]+, 0\\.[0-9]+\\] more"));
  sut.gain = statistics::paired_t_test(std::vector{0.6, 1.4, 2.7}, std::vector{1.0, 2.0, 3.0});
  EXPECT_THAT(gain_sentence(sut), ContainsRegex("left 0.433 N \\[0\\.[0-9]+, 0\\.[0-9]+\\] less"));
}

}  // namespace
}  // namespace stillhand::study::people_test
