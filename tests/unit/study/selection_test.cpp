// SPDX-License-Identifier: Apache-2.0
// Eq. SU-12 on people whose every number the test chooses.
#include "apps/study/recorded/selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "apps/study/recorded/average.hpp"
#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::selection_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// One trial of A, B and C; the RMS error of B is the argument.
Person person_of(const std::string& code, double rms_error_b_mm = 50.0, double dwell_a = 0.5) {
  Person out;
  out.code = code;
  out.identification = made::identification_of(1);
  std::int64_t place = 0;
  for (const Condition condition : kPaperConditions) {
    ++place;
    const double error_mm = condition == kB ? rms_error_b_mm : 20.0 + 0.1 * rms_error_b_mm;
    out.trials.push_back({code, "01", place, place, condition,
                          made::trial_of(error_mm, condition == kA ? dwell_a : 0.2, 0.2), 0.0});
  }
  return out;
}

Registration registration_of(const experiment::Exclusion& rules) {
  return {rules, 1, {kA, kB, kC}, {{kA, kB}}, 0.05, {}, {}, {}};
}

std::vector<std::string> codes_of(const std::vector<Person>& people) {
  std::vector<std::string> out;
  for (const Person& person : people) out.push_back(person.code);
  return out;
}

class SelectionTest : public testing::Test {
 protected:
  // Applies the rules.  @return the lines
  std::vector<std::string> apply(const experiment::Exclusion& rules) {
    return apply_rules(registration_of(rules), people_);
  }

  std::vector<Person> people_{person_of("P01", 48.0), person_of("P02", 50.0),
                              person_of("P03", 52.0)};
};

TEST_F(SelectionTest, TheDefaultRulesExcludeNobodyWhoIsComplete) {
  EXPECT_THAT(apply({}), IsEmpty());
  EXPECT_THAT(codes_of(people_), ElementsAre("P01", "P02", "P03"));
}

TEST_F(SelectionTest, ATrialThatLostMoreThanTheRuleAllowsGoesAndOneAtTheLimitStays) {
  people_[0].trials[1].lost_share = 0.02;
  people_[1].trials[1].lost_share = 0.0201;
  const experiment::Exclusion rules{.least_completed_share = 0.5};
  const auto lines = apply(rules);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("P02, session 01, trial 2: 0.0201 of its samples lost"));
  EXPECT_EQ(people_[0].trials.size(), 3u);
  EXPECT_EQ(people_[1].trials.size(), 2u);
  // Two thirds of the plan are enough for the rule, and too little for the tables.
  EXPECT_THAT(select(people_).participants, ElementsAre("P01", "P03"));
  EXPECT_THAT(select(people_).left_out, ElementsAre("P02: no complete trial of condition B"));
}

TEST_F(SelectionTest, ARepetitionDoesNotStandForAMissingTrial) {
  people_[0].trials[2].condition = kA;  // A, B, A
  const auto lines = apply({});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("P01: 0.6667 of the planned trials"));
  EXPECT_THAT(codes_of(people_), ElementsAre("P02", "P03"));
}

TEST_F(SelectionTest, TooManyTrialsEndedEarlyExcludeThePerson) {
  people_[1].broken_trials = 3;
  experiment::Exclusion rules{.most_broken_trials = 3};
  EXPECT_THAT(apply(rules), IsEmpty());
  rules.most_broken_trials = 2;
  EXPECT_THAT(apply(rules), ElementsAre(HasSubstr("P02: 3 trials ended early")));
}

TEST_F(SelectionTest, WhoCannotTrackOnAStandingPlatformIsExcluded) {
  people_.push_back(person_of("P04", 50.0, 0.19));
  const experiment::Exclusion rules{.least_dwell_ratio_a = 0.2};
  EXPECT_THAT(apply(rules), ElementsAre(HasSubstr("P04: mean dwell ratio 0.19 in A")));
}

// Four people with 49, four with 51, one with 50 and one with 70 mm in B: mean 52 mm,
// s^2 = (4 * 9 + 4 * 1 + 4 + 324)/9 mm^2, so 70 mm is 2.815 deviations away; in A and C too.
TEST_F(SelectionTest, AnErrorFarFromTheOthersExcludesByItsNumberOfDeviations) {
  people_.clear();
  for (int n = 0; n < 9; ++n) {
    people_.push_back(
        person_of("P0" + std::to_string(n + 1), n == 4 ? 50.0 : 49.0 + 2.0 * (n % 2)));
  }
  people_.push_back(person_of("P10", 70.0));
  const std::vector<Person> all = people_;
  experiment::Exclusion rules;
  rules.most_rms_deviations = 2.85;  // (n - 1)/sqrt(n) = 2.846: nobody can be further
  EXPECT_THAT(apply(rules), IsEmpty());
  rules.most_rms_deviations = 2.5;
  EXPECT_THAT(apply(rules), ElementsAre(HasSubstr("P10: RMS error")));
  EXPECT_EQ(people_.size(), 9u);
}

// Eq. SU-14.
TEST_F(SelectionTest, SeveralTrialsOfAConditionAreAveraged) {
  RecordedTrial again = people_[0].trials[1];
  again.place = again.number = 4;
  again.tracked.metrics.rms_error_mm = 44.0;  // 48 mm before
  again.tracked.metrics.crossover_hz = made::kNan;
  people_[0].trials.push_back(again);
  const Selection sut = select(people_);
  const auto& metrics = sut.results[0].trials.at(kB).metrics;
  EXPECT_EQ(metrics.rms_error_mm, 46.0);
  EXPECT_EQ(metrics.crossover_hz, 0.2);  // of the trial where it was found
  EXPECT_THAT(sut.results[0].order, testing::ElementsAre(kA, kB, kC));
  EXPECT_EQ(sut.used.size(), 10u);
}

TEST_F(SelectionTest, OfTheTrialsOfOnePlaceOfThePlanTheLastCounts) {
  for (RecordedTrial& trial : people_[0].trials) trial.step = trial.place;
  RecordedTrial again = people_[0].trials[1];
  again.place = again.number = 4;
  again.tracked.metrics.rms_error_mm = 44.0;
  people_[0].trials.push_back(again);
  const Selection sut = select(people_);
  EXPECT_EQ(sut.results[0].trials.at(kB).metrics.rms_error_mm, 44.0);
  EXPECT_EQ(sut.used.size(), 9u);
  EXPECT_FALSE(sut.used.contains({"P01", "01", 2}));
  EXPECT_THAT(apply({}), IsEmpty());  // every place of the plan has a trial
}

TEST_F(SelectionTest, ATrialThatARuleTakesAwayHasNoSayInTheMean) {
  for (RecordedTrial& trial : people_[0].trials) trial.step = trial.place;
  RecordedTrial again = people_[0].trials[1];
  again.place = again.number = 4;
  again.lost_share = 0.5;
  again.tracked.metrics.rms_error_mm = 44.0;
  people_[0].trials.push_back(again);
  EXPECT_EQ(apply({}).size(), 1u);
  // The repetition lost too many samples: the trial before it counts again.
  EXPECT_EQ(select(people_).results[0].trials.at(kB).metrics.rms_error_mm, 48.0);
}

TEST_F(SelectionTest, AConditionThatOnePersonHasAndAPersonWithFewerTrialsAreNamed) {
  people_[0].trials[2].condition = kCPlus;  // C of P01
  people_.push_back(person_of("P04", 51.0));
  for (std::size_t i = 1; i < people_.size(); ++i) {
    if (i == 2) continue;
    people_[i].trials.push_back(people_[i].trials[1]);
  }
  const Selection sut = select(people_);
  EXPECT_THAT(sut.participants, ElementsAre("P02", "P03", "P04"));
  EXPECT_THAT(sut.left_out, ElementsAre("P01: no complete trial of condition C"));
  EXPECT_THAT(sut.remarks,
              ElementsAre("condition C+: only 1 of 4 participants have it (P01)",
                          "P03: 1 of the usual 2 trials of condition B; their mean counts"));
}

// Magnitudes in decibels, angles as directions, closed loops as complex numbers.
TEST(AveragedTest, TheOpenLoopOfTwoTrialsIsBetweenThem) {
  TrackedTrial one = made::trial_of(20.0, 0.5, 0.1);
  TrackedTrial two = made::trial_of(30.0, 0.3, 0.4);
  one.metrics.moving_rms_mm = {1.0, 2.0};
  two.metrics.moving_rms_mm = {3.0, 6.0};
  const TrackedTrial sut = averaged({&one, &two});
  const auto& line = sut.metrics.lines[3];
  EXPECT_NEAR(std::abs(line.gain), 0.2 / line.frequency_hz, 1e-12);  // sqrt(0.1 * 0.4)
  EXPECT_NEAR(std::arg(line.gain), -std::acos(0.0), 1e-12);
  const auto closed = [](std::complex<double> gain) { return gain / (1.0 + gain); };
  EXPECT_NEAR(std::abs(sut.closed_loop[3] - 0.5 * (closed(one.metrics.lines[3].gain) +
                                                   closed(two.metrics.lines[3].gain))),
              0.0, 1e-15);
  EXPECT_THAT(sut.metrics.moving_rms_mm, ElementsAre(2.0, 4.0));
  EXPECT_TRUE(averaged({&one}).closed_loop.empty());
}

}  // namespace
}  // namespace stillhand::study::selection_test
