// SPDX-License-Identifier: Apache-2.0
// One subject's session, with trials of five seconds.
#include "apps/study/subjects/subject_session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "apps/study/report/output.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::study::subject_session_test {
namespace {

using testing::HasSubstr;

StudyOptions short_study(const std::string& conditions) {
  StudyOptions options;
  options.subjects = 2;
  options.protocol.conditions = session::parse_conditions(conditions, session::kStudyConditions);
  options.protocol.trial_s = 5.0;
  options.protocol.identify_s = 10.0;
  options.threads = 1;
  return options;
}

// A population without what nerves and muscles add: its force depends on the motion alone.
population::Population linear_hand() {
  population::Population out;
  out.wander = out.involuntary_force_n = out.tremor_force_n = out.unmeasured_force_n_s2_m = 0.0;
  return out;
}

TEST(StudyOptionsTest, AreCalibratedWithTheirDefaultsAndThePapersLengthsOnly) {
  StudyOptions options;
  options.protocol.identify_s = 120.0;
  EXPECT_TRUE(is_calibrated(options));
  options.subjects = 3;
  options.seed = 99;
  EXPECT_TRUE(is_calibrated(options));
  options.protocol.trial_s = 179.0;
  EXPECT_FALSE(is_calibrated(options));
  options.protocol.trial_s = 180.0;
  options.population.remnant_cv = std::nextafter(options.population.remnant_cv, 1.0);
  EXPECT_FALSE(is_calibrated(options));
}

TEST(SubjectSessionTest, EveryConditionRunsOnceInTheOrderThatIsReported) {
  const SubjectResult sut = run_subject(short_study("A,B,C,D,E,F"), 0);
  EXPECT_THAT(sut.order, testing::UnorderedElementsAre(kA, kB, kC, kD, kE, kF));
  EXPECT_EQ(sut.trials.size(), 6u);
  for (const auto& [condition, trial] : sut.trials) {
    EXPECT_TRUE(std::isfinite(trial.metrics.rms_error_mm)) << name_of(condition);
    // Five seconds at 20 Hz; the paper's excerpt of twenty is longer than the trial.
    EXPECT_EQ(trial.target_m.size(), 100u) << name_of(condition);
    EXPECT_EQ(trial.cursor_m.size(), 100u) << name_of(condition);
    EXPECT_EQ(trial.cancelled_share != 0.0, condition == kC) << name_of(condition);
  }
  // On a still platform the hand's own involuntary force is left.
  EXPECT_LT(sut.trials.at(kA).feedthrough_rms_n, 0.2 * sut.trials.at(kB).feedthrough_rms_n);
}

// Conditions differ in what is added only: with nothing added, E and F have the rig of B, and the
// motion and the noise that go with the trial's number.
TEST(SubjectSessionTest, AStickWithoutAddedDampingAndAnArmWithoutARestAreThoseOfB) {
  StudyOptions options = short_study("B");
  options.population = linear_hand();
  const double b = run_subject(options, 1).trials.at(kB).feedthrough_rms_n;
  options.damped_stick_n_s_m = 0.0;
  options.protocol.conditions = session::parse_conditions("E", session::kStudyConditions);
  const double plain = run_subject(options, 1).trials.at(kE).feedthrough_rms_n;
  // The own rig of E has no pegged trial behind it: noise and start differ, the motion does not.
  EXPECT_NEAR(plain / b, 1.0, 0.05);
  options.damped_stick_n_s_m = 40.0;
  const TrackedTrial damped = run_subject(options, 1).trials.at(kE);
  EXPECT_NE(damped.metrics.rms_error_mm, 0.0);
  EXPECT_NEAR(damped.feedthrough_rms_n / b, 1.0, 0.05);  // a force with the stick held: no say
}

TEST(SubjectSessionTest, AnotherModelMeetsTheSameMotionAndTarget) {
  const StudyOptions options = short_study("C");
  const SubjectResult own = run_subject(options, 0);
  const TrackedTrial sut = run_with_model(options, own, 0, used_model(own.identification));
  EXPECT_EQ(sut.target_m, own.trials.at(kC).target_m);
  EXPECT_NEAR(sut.feedthrough_rms_n / own.trials.at(kC).feedthrough_rms_n, 1.0, 0.05);
  EXPECT_NEAR(sut.cancelled_share, own.trials.at(kC).cancelled_share, 0.05);
  EXPECT_EQ(sut.cursor_m, run_with_model(options, own, 0, used_model(own.identification)).cursor_m);
}

// Cancellation, Eq. CC-16: 51 ms of the low-pass, 20 ms of one sample, 10 ms of the hold.
TEST(SubjectSessionTest, ThePapersCancellerIsLateByItsChain) {
  StudyOptions options = short_study("C");
  const TrackedTrial now = run_subject(options, 0).trials.at(kC);
  options.canceller = "paper";
  const TrackedTrial sut = run_subject(options, 0).trials.at(kC);
  EXPECT_EQ(sut.target_m, now.target_m);
  EXPECT_NEAR(sut.counterforce_delay_s - now.counterforce_delay_s, 0.0815, 0.005);
  EXPECT_LT(sut.cancelled_share, now.cancelled_share - 0.1);
}

TEST(SubjectSessionTest, AModelThatTheCancellerRefusesIsNotRunUnseen) {
  const StudyOptions options = short_study("C");
  const SubjectResult own = run_subject(options, 0);
  identification::FeedthroughModel unstable = used_model(own.identification);
  unstable.control.denominator.at(1) -= 1.0;
  EXPECT_THROW(run_with_model(options, own, 0, unstable), ConfigError);
}

// An arm rest of negative stiffness stands for any subject that the rig refuses.
TEST(SubjectSessionTest, ASubjectThatNoRigTakesIsNamedByNumberBeforeTheStudy) {
  StudyOptions options = short_study("F");
  options.subjects = 20;
  options.arm_rest_stiffness_n_m = -1.0;
  const std::string error = support::refusal([&] { check_subject(options, 4); });
  EXPECT_THAT(error, testing::StartsWith("population: got "));
  EXPECT_THAT(error, HasSubstr("subject 5 "));
  EXPECT_THAT(error, HasSubstr("arm_rest_stiffness_n_m"));
  EXPECT_THROW(run_study(options, [](auto, auto) { return true; }), ConfigError);
}

TEST(SubjectSessionTest, TheUndeclaredEffectIsOneForAllSubjectsOfASeed) {
  StudyOptions options = short_study("B");
  options.undeclared_effect = 5;
  const auto text = [](const StudyOptions& of) {
    return rig::sealed_text(sealed_effect(of).open(), "nonce");
  };
  const std::string sut = text(options);
  EXPECT_EQ(text(options), sut);
  options.undeclared_effect = 6;
  EXPECT_NE(text(options), sut);
  const double plain = run_subject(short_study("B"), 0).trials.at(kB).metrics.rms_error_mm;
  const double changed = run_subject(options, 0).trials.at(kB).metrics.rms_error_mm;
  EXPECT_NE(plain, changed);
}

TEST(WrongModelsTest, NeedAnotherSubjectAndTheConditionsBetweenWhichAGainLies) {
  const OnProgress go_on = [](std::int64_t, std::int64_t) { return true; };
  const auto message_of = [&](const StudyOptions& options) -> std::string {
    return support::refusal([&] { run_study(options, go_on); });
  };
  StudyOptions options = short_study("B,C");
  options.wrong_models = true;
  options.subjects = 1;
  EXPECT_THAT(message_of(options), testing::StartsWith("--wrong-models: got "));
  for (const char* conditions : {"A,B", "A,C", "A"}) {
    options = short_study(conditions);
    options.wrong_models = true;
    EXPECT_THAT(message_of(options), testing::StartsWith("--wrong-models: got ")) << conditions;
  }
}

// With two subjects the mean of all others is the other one: one least squares on one record.
TEST(WrongModelsTest, TheMeanOfOneOtherIsThatOther) {
  StudyOptions options = short_study("B,C");
  options.wrong_models = true;
  std::int64_t last = 0;
  std::int64_t whole = 0;
  const auto results = run_study(options, [&](std::int64_t done, std::int64_t all) {
    EXPECT_GE(done, last);
    last = done;
    whole = all;
    return true;
  });
  EXPECT_EQ(whole, 4);
  for (const SubjectResult& result : results) {
    if (!result.identification.paper_unusable.empty()) continue;
    const double other = result.wrong.at('O').cancelled_share;
    const double mean = result.wrong.at('M').cancelled_share;
    EXPECT_NEAR(other, mean, 1e-3);
  }
}

TEST(WrongModelsTest, ARealStudysTablesHaveAsManyCellsAsTheirHeaders) {
  StudyRecord record;
  record.options = short_study("A,B");
  record.results = run_study(record.options, [](auto, auto) { return true; });
  record.analysis = analyse(record.results);
  for (const CsvFile& file : csv_files(record)) {
    const std::string header = file.text.substr(0, file.text.find('\n'));
    const auto wanted = std::ranges::count(header, ',');
    std::istringstream lines(file.text);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_EQ(std::ranges::count(line, ','), wanted) << file.name << ": " << line;
    }
  }
}

}  // namespace
}  // namespace stillhand::study::subject_session_test
