// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/session_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::lab::session_page_test {
namespace {

using session::Condition;

using testing::HasSubstr;
using testing::Not;

session::TrialResult trial(Condition label, double rms_error_mm) {
  session::TrialResult result{};
  result.label = label;
  result.metrics.rms_error_mm = rms_error_mm;
  return result;
}

TEST(SessionPageTest, TheSessionsFiguresStandNextToThePapers) {
  session::SessionResult result;
  result.trials = {trial(Condition::kA, 20.0), trial(Condition::kB, 50.0),
                   trial(Condition::kC, 35.0)};
  LabOptions options;
  options.protocol.seed = 7;
  const std::string sut = session_page(options, {}, result, {}).html();
  for (const char* figure : {"20.00", "50.00", "35.00", "50 % (no interval)", "22.22", "52.91",
                             "38.55", "47 %", "<dd>7</dd>"}) {
    EXPECT_THAT(sut, HasSubstr(figure));
  }
  EXPECT_THAT(sut, Not(HasSubstr("Traces")));
}

TEST(SessionPageTest, ASimulatedSubjectIsNamedAndAPersonIsNot) {
  LabOptions options;
  EXPECT_THAT(session_page(options, {}, {}, {}).html(), HasSubstr("no person took part"));
  options.who = Operator::kMouse;
  EXPECT_THAT(session_page(options, {}, {}, {}).html(), Not(HasSubstr("no person took part")));
}

TEST(SessionPageTest, MoreThanAllHasItsWord) {
  session::SessionResult result;
  result.trials = {trial(Condition::kA, 20.0), trial(Condition::kB, 50.0),
                   trial(Condition::kC, 11.0)};
  EXPECT_THAT(session_page(LabOptions{}, {}, result, {}).html(),
              HasSubstr("130 % (no interval), better than A"));
}

TEST(SessionPageTest, TheFigureOfADisturbedTrialIsMarked) {
  session::SessionResult result;
  result.trials = {trial(Condition::kB, 50.0), trial(Condition::kC, 35.0)};
  session::Miss miss;
  miss.process = "sensing";
  result.disturbances = {{Condition::kC, miss}};
  const std::string sut = session_page(LabOptions{}, {}, result, {}).html();
  EXPECT_THAT(sut, HasSubstr("35.00 *<"));
  EXPECT_THAT(sut, HasSubstr("50.00<"));
  EXPECT_THAT(sut, HasSubstr("* C disturbed"));
}

TEST(SessionPageTest, ATrialThatDoesNotCountIsNamedWithItsReason) {
  session::TrialOutcome outcome;
  outcome.planned.trial.number = 3;
  outcome.planned.label = Condition::kC;
  outcome.aborted = "rig: interlock opened";
  EXPECT_THAT(session_page(LabOptions{}, {outcome}, {}, {}).html(),
              HasSubstr("trial 3, C, does not count: rig: interlock opened."));
  outcome.completed = true;
  EXPECT_THAT(session_page(LabOptions{}, {outcome}, {}, {}).html(),
              Not(HasSubstr("does not count")));
}

TEST(SessionPageTest, AfterASecondIdentificationEachTrialNamesItsModel) {
  session::TrialOutcome identified;
  identified.planned.label = Condition::kIdentification;
  identified.completed = true;
  session::SessionResult result;
  result.trials = {trial(Condition::kC, 35.0), trial(Condition::kCPlus, 30.0)};
  result.trials[0].number = 1;
  result.trials[0].models.force = 0;
  result.trials[1].number = 3;
  result.trials[1].models.force = 1000;
  const auto sut = [&](std::size_t count) {
    return session_page(LabOptions{}, {count, identified}, result, {}).html();
  };
  EXPECT_THAT(sut(1), Not(HasSubstr("identified again")));
  EXPECT_THAT(sut(2), HasSubstr("trial 1 (C) ran model 0, trial 3 (C+) ran model 1000."));
}

TEST(SessionPageTest, AConditionThatDidNotRunHasNoFigure) {
  session::SessionResult result;
  result.trials = {trial(Condition::kA, 20.0)};
  const std::string sut = session_page(LabOptions{}, {}, result, {}).html();
  EXPECT_THAT(sut, HasSubstr("20.00"));
  EXPECT_THAT(sut, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace stillhand::lab::session_page_test
