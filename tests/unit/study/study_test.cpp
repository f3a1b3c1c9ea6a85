// SPDX-License-Identifier: Apache-2.0
// The study as a whole: the paper's tables, and that a seed is a study.
#include "apps/study/subjects/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "apps/study/explain/paper_tables.hpp"
#include "apps/study/subjects/analysis.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::study::study_test {
namespace {

const OnProgress kNoProgress = [](std::int64_t, std::int64_t) { return true; };

StudyOptions study_of(std::int64_t subjects, double trial_s, double identify_s) {
  StudyOptions options;
  options.subjects = subjects;
  options.protocol.conditions = session::parse_conditions("A,B,C");
  options.protocol.trial_s = trial_s;
  options.protocol.identify_s = identify_s;
  return options;
}

// The paper's protocol once, for all tests that look at its numbers.
class PaperStudyTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    results_ = new std::vector<SubjectResult>(run_study(study_of(12, 180.0, 120.0), kNoProgress));
    analysis_ = new Analysis(analyse(*results_));
  }
  static void TearDownTestSuite() {
    delete results_;
    delete analysis_;
  }
  static std::vector<SubjectResult>* results_;
  static Analysis* analysis_;
};
std::vector<SubjectResult>* PaperStudyTest::results_ = nullptr;
Analysis* PaperStudyTest::analysis_ = nullptr;

// What the population was calibrated on, at a seed that it was not calibrated with.  Paper and
// study are draws of twelve: their difference has sqrt(2) of the paper's standard error.
TEST_F(PaperStudyTest, ConditionsAAndBAreThoseOfTableI) {
  const PaperTables paper = paper_tables(kPaperUnit_mm);
  for (std::size_t k = 0; k < kMetricCount; ++k) {
    const double a = analysis_->conditions.at(kA)[k].mean;
    const double b = analysis_->conditions.at(kB)[k].mean;
    const auto mean_a = static_cast<Eigen::Index>(k);
    const auto b_less_a = static_cast<Eigen::Index>(kMetricCount + k);
    const double bound = 2.0 * std::sqrt(2.0);
    EXPECT_NEAR(a, paper.values[mean_a], bound * paper.standard_error[mean_a]);
    EXPECT_NEAR(b - a, paper.values[b_less_a], bound * paper.standard_error[b_less_a]);
  }
}

TEST_F(PaperStudyTest, EverySignificanceOfThePaperIsFoundBelowOnePercent) {
  ASSERT_EQ(analysis_->comparisons.size(), 2u);
  for (const Comparison& comparison : analysis_->comparisons) {
    for (const auto& test : comparison.tests) {
      ASSERT_TRUE(test.has_value());
      EXPECT_LT(test->p, 0.01);
    }
  }
  ASSERT_TRUE(analysis_->main_effects.manova.has_value());
  EXPECT_LT(analysis_->main_effects.manova->condition.wilks.p, 0.01);
  EXPECT_LT(analysis_->main_effects.manova->subject.wilks.p, 0.01);
}

// C is a prediction: bounded only by what any cancellation must do, on both sides.
TEST_F(PaperStudyTest, CancellationRestoresPartOfWhatMotionTook) {
  for (const auto& restored : analysis_->restoration.at(kC)) {
    ASSERT_TRUE(restored.share.has_value());
    EXPECT_GT(*restored.share, 0.2);
    EXPECT_LT(*restored.share, 1.0);
  }
}

// Paper IV-A, on the models as identified: about 10 dB at 0 Hz, notch between 5 and 8 Hz.
TEST_F(PaperStudyTest, TheIdentifiedModelsHaveTheShapeOfThePapersFigureSix) {
  int notches = 0;
  double mean_db = 0.0;
  for (const SubjectResult& result : *results_) {
    const auto magnitude = [&](double hz) {
      return std::abs(signal::response_at(result.identification.refined.model, hz));
    };
    mean_db += 20.0 * std::log10(magnitude(0.0)) / 12.0;
    double notch_hz = 0.0;
    for (double f = 3.5; f < 9.0; f += 0.05) {
      if (magnitude(f) < magnitude(f - 0.05) && magnitude(f) <= magnitude(f + 0.05)) notch_hz = f;
    }
    if (notch_hz > 5.0 && notch_hz < 8.0) ++notches;
    EXPECT_EQ(result.identification.paper_unusable, "");
  }
  EXPECT_NEAR(mean_db, 10.0, 1.5);
  EXPECT_GE(notches, 9);
}

TEST_F(PaperStudyTest, TheEstimateThroughTheReferenceAgreesWhereTheRemnantIsSmall) {
  const auto& lines = analysis_->open_loop.at(kA);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_NEAR(lines[k].paper_db, lines[k].reference_db, 1.5) << lines[k].frequency_hz << " Hz";
  }
}

// Scheduling must not reach the numbers.
TEST(StudyTest, TheSameSeedGivesTheSameBitsWhateverTheNumberOfThreads) {
  StudyOptions options = study_of(5, 20.0, 20.0);
  options.wrong_models = true;
  options.threads = 1;
  const auto alone = run_study(options, kNoProgress);
  options.threads = 4;
  const auto together = run_study(options, kNoProgress);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].order, together[i].order);
    for (const auto& [condition, trial] : alone[i].trials) {
      EXPECT_EQ(trial.metrics.rms_error_mm, together[i].trials.at(condition).metrics.rms_error_mm);
      EXPECT_EQ(trial.cursor_m, together[i].trials.at(condition).cursor_m);
    }
    EXPECT_EQ(alone[i].wrong.at('M').metrics.rms_error_mm,
              together[i].wrong.at('M').metrics.rms_error_mm);
  }
}

TEST(StudyTest, MoreSubjectsLeaveTheFirstOnesAsTheyWere) {
  const auto few = run_study(study_of(2, 20.0, 20.0), kNoProgress);
  const auto more = run_study(study_of(3, 20.0, 20.0), kNoProgress);
  EXPECT_EQ(few[1].trials.at(kC).cursor_m, more[1].trials.at(kC).cursor_m);
}

TEST(StudyTest, TheOrderOfConditionsIsShuffledBySubject) {
  std::set<std::vector<Condition>> orders;
  for (const SubjectResult& result : run_study(study_of(8, 5.0, 10.0), kNoProgress)) {
    orders.insert(result.order);
  }
  EXPECT_GE(orders.size(), 3u);
}

// Each mitigation changes what it says: D leaves the hand as it is, E and F the stick and the arm.
TEST(StudyTest, EveryMitigationHelpsAgainstMotionAlone) {
  StudyOptions options = study_of(4, 60.0, 40.0);
  options.protocol.conditions = session::parse_conditions("B,D,F", session::kStudyConditions);
  const Analysis analysis = analyse(run_study(options, kNoProgress));
  for (const Condition condition : {kD, kF}) {
    EXPECT_LT(analysis.conditions.at(condition)[0].mean, analysis.conditions.at(kB)[0].mean);
  }
}

// The shortest trials that the options allow: fewer samples than a segment of Fig. 4.
TEST(StudyTest, TheShortestTrialsThereAreGiveAStudy) {
  const auto results = run_study(study_of(2, 5.0, 5.0), kNoProgress);
  EXPECT_FALSE(results.front().identification.estimate.frequency_hz.empty());
}

TEST(StudyTest, OneSubjectGivesMeansAndNoTests) {
  const Analysis analysis = analyse(run_study(study_of(1, 20.0, 20.0), kNoProgress));
  EXPECT_FALSE(analysis.conditions.at(kA)[0].standard_deviation.has_value());
  EXPECT_FALSE(analysis.comparisons.front().tests[0].has_value());
  EXPECT_FALSE(analysis.main_effects.manova.has_value());
  EXPECT_NE(analysis.main_effects.reason, "");
}

TEST(StudyTest, NoSubjectsOrTooManyAreRefused) {
  EXPECT_THROW(run_study(study_of(0, 20.0, 20.0), kNoProgress), ConfigError);
  EXPECT_THROW(run_study(study_of(kMaxSubjects + 1, 20.0, 20.0), kNoProgress), ConfigError);
}

TEST(StudyTest, StopsWhenToldSo) {
  EXPECT_THROW(
      run_study(study_of(200, 180.0, 120.0), [](std::int64_t, std::int64_t) { return false; }),
      Interrupted);
}

}  // namespace
}  // namespace stillhand::study::study_test
