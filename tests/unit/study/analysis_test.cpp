// SPDX-License-Identifier: Apache-2.0
// Eqs SU-3 to SU-5 and the comparisons of conditions, on results with chosen numbers.
#include "apps/study/subjects/analysis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::analysis_test {
namespace {

using made::kNan;
using made::random_results;
using made::trial_of;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kError = 0;
constexpr std::size_t kDwell = 1;
constexpr std::size_t kCrossover = 2;
constexpr std::size_t kShare = session::index_of("cancelled_share");
// Sums of at most some hundred numbers of one size, each operation exact to 2^-53: 1e-13 of them.
constexpr double kRounding = 1e-13;

// One subject a row: crossover under A, B and C; the other metrics follow from it.
std::vector<SubjectResult> with_crossovers(const std::vector<std::array<double, 3>>& rows) {
  std::vector<SubjectResult> results;
  for (const auto& row : rows) {
    SubjectResult result;
    result.trials[kA] = trial_of(20.0 + row[0], 0.5 - row[0], row[0]);
    result.trials[kB] = trial_of(50.0 + row[1], 0.2 + row[1], row[1]);
    result.trials[kC] = trial_of(30.0 + row[2], 0.3 + row[2], row[2]);
    results.push_back(result);
  }
  return results;
}

TEST(SummarisedTest, AreMeanDeviationAndQuartilesOfTheValues) {
  const MetricSample sut = summarised({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(sut.mean, 2.5);
  EXPECT_NEAR(sut.standard_deviation.value(), std::sqrt(5.0 / 3.0), kRounding);
  EXPECT_EQ(sut.known, 4u);
  EXPECT_EQ(sut.box.median, 2.5);
  EXPECT_EQ(sut.box.minimum, 1.0);
  EXPECT_EQ(sut.box.maximum, 4.0);
  EXPECT_THAT(sut.per_subject, ElementsAre(4.0, 1.0, 3.0, 2.0));
}

TEST(SummarisedTest, AValueThatWasNotFoundKeepsItsPlaceAndHasNoSay) {
  const double infinity = std::numeric_limits<double>::infinity();
  const MetricSample sut = summarised({1.0, kNan, 3.0, infinity, -infinity});
  EXPECT_EQ(sut.mean, 2.0);
  EXPECT_EQ(sut.known, 2u);
  ASSERT_EQ(sut.per_subject.size(), 5u);
  EXPECT_TRUE(std::isnan(sut.per_subject[1]));
}

TEST(SummarisedTest, OneKnownValueHasAMeanAndNoDeviation) {
  const MetricSample sut = summarised({kNan, 7.0});
  EXPECT_EQ(sut.mean, 7.0);
  EXPECT_FALSE(sut.standard_deviation.has_value());
}

TEST(SummarisedTest, WithoutAKnownValueTheMeanIsNotANumber) {
  for (const auto& values : {std::vector<double>{}, std::vector<double>{kNan, kNan}}) {
    const MetricSample sut = summarised(values);
    EXPECT_TRUE(std::isnan(sut.mean));
    EXPECT_EQ(sut.known, 0u);
    EXPECT_FALSE(sut.standard_deviation.has_value());
  }
}

TEST(SummarisedTest, TheOrderOfSubjectsDoesNotMoveTheBox) {
  std::mt19937_64 engine(51);
  std::normal_distribution<double> any(30.0, 10.0);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> values(2 + engine() % 20);
    for (double& value : values) value = any(engine);
    const MetricSample first = summarised(values);
    std::ranges::shuffle(values, engine);
    const MetricSample sut = summarised(values);
    ASSERT_NEAR(sut.mean, first.mean, 60.0 * kRounding);
    ASSERT_EQ(sut.box.median, first.box.median);
    ASSERT_EQ(sut.box.upper_quartile, first.box.upper_quartile);
    ASSERT_LE(sut.box.minimum, sut.mean);
    ASSERT_GE(sut.box.maximum, sut.mean);
  }
}

// Eq. SU-5 by hand: (B - C) / (B - A) of the means.
TEST(AnalyseTest, RestorationIsTheShareOfTheLossThatComesBack) {
  const Analysis sut = analyse(with_crossovers({{0.30, 0.10, 0.15}, {0.20, 0.10, 0.15}}));
  EXPECT_NEAR(sut.restoration.at(kC)[kCrossover].share.value(), (0.1 - 0.15) / (0.1 - 0.25),
              kRounding);
  EXPECT_NEAR(sut.restoration.at(kC)[kError].share.value(), (50.1 - 30.15) / (50.1 - 20.25),
              kRounding);
}

TEST(AnalyseTest, ASubjectWhoseCrossoverIsMissingInOneConditionIsLeftOutOfItsRestoration) {
  const Analysis sut =
      analyse(with_crossovers({{0.30, 0.10, 0.15}, {0.20, kNan, 0.50}, {0.20, 0.10, 0.15}}));
  EXPECT_NEAR(sut.restoration.at(kC)[kCrossover].share.value(), (0.1 - 0.15) / (0.1 - 0.25),
              kRounding);
  EXPECT_EQ(sut.conditions.at(kB)[kCrossover].known, 2u);
}

TEST(AnalyseTest, WithoutALossThereIsNoRestoration) {
  const Analysis same = analyse(with_crossovers({{0.25, 0.25, 0.5}, {0.5, 0.5, 0.5}}));
  EXPECT_FALSE(same.restoration.at(kC)[kCrossover].share.has_value());
  const Analysis unknown = analyse(with_crossovers({{kNan, 0.25, 0.5}, {0.5, kNan, 0.5}}));
  EXPECT_FALSE(unknown.restoration.at(kC)[kCrossover].share.has_value());
}

TEST(AnalyseTest, CPrimeAndCPlusAreComparedWithBAndWithTheCancellerBeforeThem) {
  auto results = random_results(6, "ABC", 9);
  for (SubjectResult& result : results) {
    result.trials[kCPrime] = result.trials[kA];
    result.trials[kCPlus] = result.trials[kB];
  }
  const Analysis sut = analyse(results);
  std::vector<std::string> pairs;
  for (const Comparison& each : sut.comparisons) pairs.push_back(pair_word(each.from, each.to));
  EXPECT_THAT(pairs, ElementsAre("A-B", "B-C", "B-C'", "B-C+", "C-C'", "C'-C+", "C-C+"));
  EXPECT_NEAR(sut.restoration.at(kCPrime)[kError].share.value(), 1.0, 1e-9);
  EXPECT_NEAR(sut.restoration.at(kCPlus)[kError].share.value(), 0.0, 1e-9);
  EXPECT_TRUE(gives(kCPlus, session::kNumbers[kShare]));
}

// C as good as A is 1, C as bad as B is 0, whatever the numbers.
TEST(AnalyseTest, RestorationIsOneForConditionAAgainAndZeroForConditionBAgain) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    auto results = random_results(5, "ABC", seed);
    for (SubjectResult& result : results) result.trials[kC] = result.trials[kA];
    // A copy: the analysis lives until the end of the statement.
    const Restoration whole = analyse(results).restoration.at(kC);
    for (const auto& restored : whole) {
      ASSERT_NEAR(restored.share.value(), 1.0, 1e-9);
    }
    for (SubjectResult& result : results) result.trials[kC] = result.trials[kB];
    const Restoration none = analyse(results).restoration.at(kC);
    for (const auto& restored : none) {
      ASSERT_NEAR(restored.share.value(), 0.0, 1e-9);
    }
  }
}

// t = mean(d) sqrt(n) / s of d = second condition - first, written out here.
TEST(AnalyseTest, AComparisonIsTheSecondConditionMinusTheFirst) {
  const auto results = random_results(9, "ABC", 3);
  const Analysis sut = analyse(results);
  ASSERT_EQ(sut.comparisons.size(), 2u);
  for (const Comparison& comparison : sut.comparisons) {
    double sum = 0.0;
    double square = 0.0;
    for (const SubjectResult& result : results) {
      const double d = result.trials.at(comparison.to).metrics.dwell_ratio -
                       result.trials.at(comparison.from).metrics.dwell_ratio;
      sum += d;
      square += d * d;
    }
    const double s = std::sqrt((square - sum * sum / 9.0) / 8.0);
    const auto& test = comparison.tests[kDwell].value();
    EXPECT_NEAR(test.mean_difference, sum / 9.0, 1e-12);
    EXPECT_NEAR(test.t, sum / 9.0 * 3.0 / s, 1e-9);
    EXPECT_EQ(test.degrees_of_freedom, 8.0);
  }
}

std::vector<std::string> compared(const std::string& conditions) {
  std::vector<std::string> names;
  for (const Comparison& each : analyse(random_results(4, conditions, 1)).comparisons) {
    names.push_back(pair_word(each.from, each.to));
  }
  return names;
}

TEST(AnalyseTest, MotionIsComparedWithStandingStillAndEveryRemedyWithMotion) {
  EXPECT_THAT(compared("ABC"), ElementsAre("A-B", "B-C"));
  EXPECT_THAT(compared("FEDCBA"), ElementsAre("A-B", "B-C", "B-D", "B-E", "B-F"));
  EXPECT_THAT(compared("BDF"), ElementsAre("B-D", "B-F"));
  EXPECT_THAT(compared("ACDEF"), ElementsAre());
}

TEST(AnalyseTest, ACrossoverThatOneSubjectLacksLeavesTheOtherMetricsTheirTests) {
  const Analysis sut =
      analyse(with_crossovers({{0.3, 0.1, 0.2}, {0.2, 0.15, 0.1}, {0.4, 0.1, 0.3}}));
  EXPECT_TRUE(sut.comparisons[0].tests[kCrossover].has_value());
  auto results = random_results(5, "ABC", 4);
  results[2].trials[kB].metrics.crossover_hz = kNan;
  const Analysis lacking = analyse(results);
  for (const Comparison& comparison : lacking.comparisons) {
    EXPECT_TRUE(comparison.tests[kError].has_value());
    EXPECT_FALSE(comparison.tests[kCrossover].has_value());
  }
  EXPECT_FALSE(lacking.main_effects.manova.has_value());
  EXPECT_NE(lacking.main_effects.reason, "");
}

TEST(AnalyseTest, EqualDifferencesHaveNoTest) {
  auto results = random_results(3, "AB", 5);
  for (SubjectResult& result : results) {
    result.trials[kA].metrics.rms_error_mm = 20.0;
    result.trials[kB].metrics.rms_error_mm = 45.0;
  }
  EXPECT_FALSE(analyse(results).comparisons.front().tests[kError].has_value());
}

TEST(AnalyseTest, WithoutOneOfThePapersConditionsTheReasonSaysWhichAreNeeded) {
  for (const char* conditions : {"A", "AB", "BC", "BCDEF", "AC"}) {
    const Analysis sut = analyse(random_results(4, conditions, 6));
    EXPECT_FALSE(sut.main_effects.manova.has_value()) << conditions;
    EXPECT_THAT(sut.main_effects.reason, HasSubstr("A, B and C")) << conditions;
    EXPECT_THAT(sut.thirds.reason, HasSubstr("A, B and C")) << conditions;
  }
}

// S subjects, 3 conditions: (S-1)(3-1) degrees of freedom of the error with one trial a cell,
// 3 S (3-1) with thirds as replicates (ST-7), which allow a test of the interaction.
TEST(AnalyseTest, TheThirdsOfATrialAreReplicatesOfItsCell) {
  const Analysis sut = analyse(random_results(6, "CBA", 7));
  ASSERT_TRUE(sut.main_effects.manova.has_value()) << sut.main_effects.reason;
  EXPECT_EQ(sut.main_effects.manova->error_df, 10.0);
  EXPECT_FALSE(sut.main_effects.manova->interaction.has_value());
  ASSERT_TRUE(sut.thirds.manova.has_value()) << sut.thirds.reason;
  EXPECT_EQ(sut.thirds.manova->error_df, 36.0);
  EXPECT_TRUE(sut.thirds.manova->interaction.has_value());
}

// ST-7 with q conditions: (S-1)(q-1) degrees of freedom with one trial a cell, q S (3-1) with
// thirds.
TEST(AnalyseTest, OtherConditionsThanThePapersHaveTestsOverAllOfThem) {
  EXPECT_FALSE(analyse(random_results(6, "ABC", 7)).all_main_effects);
  EXPECT_FALSE(analyse(random_results(6, "A", 7)).all_main_effects);
  const std::vector<Condition> all{kA, kB, kC, kCPrime, kCPlus};
  for (const auto& [conditions, words] :
       {std::pair{all, "A, B, C, C', C+"}, {{kB, kC, kCPlus}, "B, C, C+"}, {{kA, kB}, "A, B"}}) {
    const Analysis sut = analyse(random_results(6, conditions, 7));
    const auto count = static_cast<double>(conditions.size());
    EXPECT_EQ(words_of_conditions(sut), words);
    ASSERT_TRUE(sut.all_main_effects && sut.all_main_effects->manova) << words;
    EXPECT_EQ(sut.all_main_effects->manova->error_df, 5.0 * (count - 1.0));
    ASSERT_TRUE(sut.all_thirds && sut.all_thirds->manova) << words;
    EXPECT_EQ(sut.all_thirds->manova->error_df, 6.0 * count * 2.0);
  }
  const Analysis paper = analyse(random_results(6, "ABC", 7));
  EXPECT_EQ(analyse(random_results(6, all, 7)).main_effects.manova->error_df,
            paper.main_effects.manova->error_df);
}

// 51 window starts of a minute: windows at 0, 10, .. 50 s, two a third.  What lies between them,
// and so would count a second twice, has no say.
TEST(AnalyseTest, AThirdIsMadeOfWindowsThatDoNotOverlap) {
  auto results = random_results(6, "ABC", 8);
  const double lambda = analyse(results).thirds.manova->condition.wilks_lambda;
  for (SubjectResult& result : results) {
    for (auto& [condition, trial] : result.trials) {
      for (std::size_t s = 0; s < trial.metrics.moving_rms_mm.size(); ++s) {
        if (s % 10 == 0) continue;
        trial.metrics.moving_rms_mm[s] = kNan;
        trial.metrics.moving_dwell[s] = kNan;
      }
    }
  }
  EXPECT_EQ(analyse(results).thirds.manova->condition.wilks_lambda, lambda);
  results[0].trials[kB].metrics.moving_rms_mm[50] += 5.0;
  EXPECT_NE(analyse(results).thirds.manova->condition.wilks_lambda, lambda);
}

TEST(AnalyseTest, TrialsTooShortForThirdsSayWhichLengthIsNeeded) {
  auto results = random_results(4, "ABC", 9);
  for (const std::size_t starts : {std::size_t{0}, std::size_t{20}, std::size_t{21}}) {
    for (SubjectResult& result : results) {
      for (auto& [condition, trial] : result.trials) {
        trial.metrics.moving_rms_mm.assign(starts, 30.0);
        trial.metrics.moving_dwell.assign(starts, 0.3);
      }
    }
    const Analysis sut = analyse(results);
    EXPECT_FALSE(sut.thirds.manova.has_value());
    // 21 starts are 30 s: one window a third, though these do not vary.
    EXPECT_EQ(sut.thirds.reason.find("30 s") != std::string::npos, starts < 21) << starts;
  }
}

// Eq. SU-3: two subjects with G = 1 and G = 3.  X_p/X_r = 1/2 and 3/4, X_e/X_r = 1/2 and 1/4:
// together (5/4) / (3/4).  The paper's number is the mean of 0 dB and 20 log 3.
TEST(AnalyseTest, ThePooledOpenLoopIsTheQuotientOfTheMeans) {
  auto results = random_results(2, "B", 10);
  results[0].trials[kB].metrics.lines[4].gain = 1.0;
  results[1].trials[kB].metrics.lines[4].gain = 3.0;
  const PooledLine sut = analyse(results).open_loop.at(kB)[4];
  EXPECT_NEAR(sut.reference_db, 20.0 * std::log10(5.0 / 3.0), 1e-12);
  EXPECT_NEAR(sut.paper_db, 10.0 * std::log10(3.0), 1e-12);
}

TEST(AnalyseTest, SubjectsWhoAgreeHaveTheSameOpenLoopByBothEstimates) {
  std::mt19937_64 engine(52);
  std::uniform_real_distribution<double> any(-2.0, 2.0);
  auto results = random_results(5, "A", 11);
  for (int i = 0; i < 50; ++i) {
    const std::complex<double> gain(any(engine), any(engine));
    for (SubjectResult& result : results) result.trials[kA].metrics.lines[0].gain = gain;
    const PooledLine sut = analyse(results).open_loop.at(kA)[0];
    ASSERT_NEAR(sut.paper_db, 20.0 * std::log10(std::abs(gain)), 1e-11);
    // 1 + G may be small: its relative rounding error grows to 1e-16 / |1 + G|.
    ASSERT_NEAR(sut.reference_db, sut.paper_db, 1e-12 / std::abs(1.0 + gain) + 1e-11);
  }
}

TEST(AnalyseTest, TheRemnantsShareIsTheMedianAndNeverAboveOne) {
  auto results = random_results(3, "A", 12);
  const auto set = [&](double a, double b, double c) {
    results[0].trials[kA].metrics.lines[7].error_snr = a;
    results[1].trials[kA].metrics.lines[7].error_snr = b;
    results[2].trials[kA].metrics.lines[7].error_snr = c;
    return analyse(results).open_loop.at(kA)[7].remnant_share;
  };
  EXPECT_EQ(set(2.0, 4.0, 8.0), 0.25);
  EXPECT_EQ(set(0.1, 0.5, 8.0), 1.0);
  EXPECT_EQ(set(0.0, 4.0, 8.0), 0.25);
}

// Eq. SU-4 by hand: (B - C_wrong) / (B - C_own).
TEST(AnalyseTest, TheSurvivingShareIsOfTheOwnModelsGain) {
  auto results = random_results(3, "BC", 13);
  const auto set = [&](std::size_t i, double b, double own, double wrong) {
    results[i].trials[kB].metrics.rms_error_mm = b;
    results[i].trials[kC].metrics.rms_error_mm = own;
    results[i].wrong['O'] = trial_of(wrong, 0.3, 0.2);
  };
  set(0, 50.0, 30.0, 35.0);
  set(1, 50.0, 48.0, 35.0);  // a gain of 4 % of B: nothing to take a share of
  set(2, 40.0, 30.0, 45.0);  // worse than without a motor
  const Analysis sut = analyse(results);
  const auto& shares = sut.wrong.at('O').surviving_share;
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_NEAR(shares[0], 0.75, kRounding);
  EXPECT_TRUE(std::isnan(shares[1]));
  EXPECT_NEAR(shares[2], -0.5, kRounding);
  EXPECT_NEAR(sut.wrong.at('O').metrics[kError].mean, 115.0 / 3.0, 1e-12);
}

TEST(AnalyseTest, OnlyConditionCHasACancelledShare) {
  const auto results = random_results(4, "ABC", 14);
  const Analysis sut = analyse(results);
  const session::Number& share = session::kNumbers[kShare];
  EXPECT_FALSE(gives(kA, share));
  EXPECT_FALSE(gives(kB, share));
  EXPECT_FALSE(gives(kD, share));
  EXPECT_TRUE(gives(kC, share));
  double sum = 0.0;
  for (const SubjectResult& result : results) sum += result.trials.at(kC).cancelled_share;
  EXPECT_NEAR(sut.conditions.at(kC)[kShare].mean, sum / 4.0, kRounding);
}

TEST(AnalyseTest, SubjectsWhosePapersFitCouldNotCancelAreCounted) {
  auto results = random_results(4, "A", 15);
  EXPECT_EQ(analyse(results).refined_used, 0);
  results[1].identification.paper_unusable = "unstable";
  results[3].identification.paper_unusable = "too slow";
  EXPECT_EQ(analyse(results).refined_used, 2);
}

}  // namespace
}  // namespace stillhand::study::analysis_test
