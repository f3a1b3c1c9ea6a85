// SPDX-License-Identifier: Apache-2.0
// The numbers in the study's figures; tests of the report cover how they are drawn.
#include "apps/study/report/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/study/made_record.hpp"

namespace stillhand::study::figures_test {
namespace {

using made::kNan;
using made::random_results;
using made::record_of;
using report::Figure;
using report::Kind;
using report::Panel;
using report::Series;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Not;

std::vector<std::string> names_of(const StudyRecord& record) {
  std::vector<std::string> names;
  for (const Figure& figure : study_figures(record)) names.push_back(figure.name);
  return names;
}

StudyRecord with_wrong_models(std::vector<double> shares) {
  auto results = random_results(shares.size(), "ABC", 81);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    results[i].trials[kB].metrics.rms_error_mm = 50.0;
    results[i].trials[kC].metrics.rms_error_mm = 30.0;
    results[i].wrong['O'] = made::trial_of(50.0 - 20.0 * shares[i], 0.3, 0.2);
  }
  return record_of(results);
}

TEST(StudyFiguresTest, AWholeStudyHasEveryFigureOnceAndNoOther) {
  auto names = names_of(with_wrong_models({0.5, 0.7}));
  std::ranges::sort(names);
  std::vector<std::string> known(kFigureNames.begin(), kFigureNames.end());
  std::ranges::sort(known);
  // Of recorded people alone.
  std::erase(known, kGainFigure);
  std::erase(known, kSimulatedFigure);
  EXPECT_EQ(names, known);
}

TEST(StudyFiguresTest, AFigureWhoseConditionsWereNotRunIsLeftOut) {
  const auto names = names_of(record_of(random_results(2, "DEF", 82)));
  for (const char* absent :
       {"fig07_traces", "fig08_moving_rms", "fig12_open_loop", "wrong_models"}) {
    EXPECT_THAT(names, Not(Contains(absent)));
  }
  EXPECT_THAT(names, Contains("fig10_rms_error"));
  auto results = random_results(2, "ABC", 83);
  for (SubjectResult& result : results) {
    for (auto& [condition, trial] : result.trials) {
      trial.metrics.moving_rms_mm.clear();
      trial.metrics.moving_dwell.clear();
    }
  }
  EXPECT_THAT(names_of(record_of(results)), Not(Contains("fig09_moving_dwell")));
}

// draw() requires this of a series, for any set of conditions and number of subjects.
TEST(StudyFiguresTest, TheArraysOfOneSeriesAreEquallyLong) {
  for (const char* conditions : {"A", "B", "CB", "ABCDEF", "F"}) {
    for (const std::size_t subjects : {std::size_t{1}, std::size_t{5}, std::size_t{13}}) {
      for (const Figure& figure :
           study_figures(record_of(random_results(subjects, conditions, 84)))) {
        for (const Panel& panel : figure.panels) {
          for (const Series& series : panel.series) {
            if (series.kind == Kind::kBox) continue;
            const bool band = series.kind == Kind::kBand;
            EXPECT_EQ(series.x.size(), band ? series.y_low.size() : series.y.size()) << figure.name;
            if (band) {
              EXPECT_EQ(series.x.size(), series.y_high.size()) << figure.name;
            }
          }
        }
      }
    }
  }
}

TEST(StudyFiguresTest, TheTypicalSubjectHasTheMedianErrorUnderMotion) {
  auto results = random_results(5, "AB", 85);
  const std::array<double, 5> errors_mm{90.0, 20.0, 52.0, 30.0, 80.0};
  for (std::size_t i = 0; i < 5; ++i) {
    results[i].trials[kB].metrics.rms_error_mm = errors_mm[i];
    results[i].trials[kA].metrics.rms_error_mm = 20.0 + static_cast<double>(i);
  }
  EXPECT_EQ(typical_subject(record_of(results)), 2u);
  for (SubjectResult& result : results) result.trials.erase(kB);
  EXPECT_EQ(typical_subject(record_of(results)), 2u);
  results[2].trials[kA].metrics.rms_error_mm = 99.0;
  EXPECT_EQ(typical_subject(record_of(results)), 3u);
}

TEST(StudyFiguresTest, ConditionsAreGivenInTheOrderThatIsAskedFor) {
  const StudyRecord record = record_of(random_results(1, "ACF", 86));
  EXPECT_THAT(conditions_run(record, kPaperConditions), testing::ElementsAre(kA, kC));
  EXPECT_THAT(conditions_run(record, std::array{kF, kE, kD, kC, kB, kA}),
              testing::ElementsAre(kF, kC, kA));
  EXPECT_THAT(conditions_run(record, {}), testing::IsEmpty());
}

TEST(StudyFiguresTest, EveryConditionHasAColourOfItsOwn) {
  std::set<report::Colour> colours;
  for (const Condition each : session::conditions_of(session::kStudyConditions)) {
    colours.insert(colour_of(each));
  }
  EXPECT_EQ(colours.size(), 6u);
  EXPECT_FALSE(colours.contains(report::Colour::kNeutral));
}

TEST(FigureBoxTest, ABoxIsTheFiveNumbersOfItsCondition) {
  const StudyRecord record = record_of(random_results(7, "BA", 87));
  const Panel sut = figure_box(record, 1).panels.at(0);
  ASSERT_EQ(sut.series.size(), 5u);  // of each condition a box and its subjects; the paper
  EXPECT_THAT(sut.series[3].y,
              testing::ElementsAreArray(record.analysis.conditions.at(kB)[1].per_subject));
  const auto& want = record.analysis.conditions.at(kB)[1].box;
  const report::Box& box = sut.series[2].boxes.at(0);
  EXPECT_EQ(box.low, want.minimum);
  EXPECT_EQ(box.lower_quartile, want.lower_quartile);
  EXPECT_EQ(box.median, want.median);
  EXPECT_EQ(box.upper_quartile, want.upper_quartile);
  EXPECT_EQ(box.high, want.maximum);
  EXPECT_EQ(box.at, sut.x.ticks.at(1).at);
}

TEST(FigureBoxTest, ThePapersMeansStandAtTheirOwnConditions) {
  const StudyRecord record = record_of(random_results(2, "ACDE", 88));
  const Panel sut = figure_box(record, 0).panels.at(0);
  const Series& paper = sut.series.back();
  ASSERT_EQ(paper.kind, Kind::kPoints);
  // Table I and II, 5.5 mm a unit; there is no B here, and no D or E in the paper.
  EXPECT_THAT(paper.y, ElementsAre(5.5 * 4.04, 5.5 * 7.01));
  EXPECT_THAT(paper.x, ElementsAre(sut.x.ticks[0].at, sut.x.ticks[1].at));
  EXPECT_THAT(figure_box(record, 2).panels.at(0).series.back().y, ElementsAre(0.25, 0.14));
  const Panel without = figure_box(record_of(random_results(2, "DE", 88)), 0).panels.at(0);
  EXPECT_THAT(without.series, Each(testing::Field(&Series::label, testing::IsEmpty())));
}

// A crossover of 0 Hz would be a result; none was found.
TEST(FigureBoxTest, AConditionWithoutAnyCrossoverHasAPlaceAndNoBox) {
  auto results = random_results(3, "AB", 89);
  for (SubjectResult& result : results) result.trials[kA].metrics.crossover_hz = kNan;
  const Panel sut = figure_box(record_of(results), 2).panels.at(0);
  EXPECT_EQ(sut.x.ticks.size(), 2u);
  std::vector<double> places;
  for (const Series& series : sut.series) {
    for (const report::Box& box : series.boxes) places.push_back(box.at);
  }
  EXPECT_THAT(places, ElementsAre(sut.x.ticks[1].at));
}

TEST(FigureOpenLoopTest, TheLineOfTwentyDecibelsADecadeCrossesZeroAtTheCrossover) {
  const StudyRecord record = record_of(random_results(1, "B", 90));
  const double crossover_hz = record.results[0].trials.at(kB).metrics.crossover_hz;
  const Figure sut = figure_open_loop(record);
  ASSERT_EQ(sut.panels.size(), 2u);
  const Series& line = sut.panels[0].series.at(0);
  EXPECT_EQ(line.x.size(), 11u);  // paper III-C: the lowest eleven
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    EXPECT_NEAR(line.y[i], -20.0 * std::log10(line.x[i] / crossover_hz), 1e-12);
  }
  // The made open loop is an integrator: its points lie on the line, its phase is -90 degrees.
  const Series& points = sut.panels[0].series.at(1);
  ASSERT_EQ(points.x.size(), signal::kReferenceLines);
  for (std::size_t i = 0; i < 11; ++i) EXPECT_NEAR(points.y[i], line.y[i], 1e-12);
  EXPECT_THAT(sut.panels[1].series.at(0).y, Each(testing::DoubleNear(-90.0, 1e-12)));
}

TEST(FigureOpenLoopTest, EveryPhaseIsWithinThePanel) {
  std::mt19937_64 engine(91);
  std::normal_distribution<double> any;
  auto results = random_results(1, "A", 91);
  for (int i = 0; i < 50; ++i) {
    for (auto& line : results[0].trials[kA].metrics.lines) line.gain = {any(engine), any(engine)};
    const Panel sut = figure_open_loop(record_of(results)).panels.at(1);
    for (const double phase_deg : sut.series.at(0).y) {
      ASSERT_GE(phase_deg, sut.y.low.value());
      ASSERT_LE(phase_deg, sut.y.high.value());
    }
  }
}

// Two subjects with 10 and 20 mm in every window: 15 mm, deviation 10 / sqrt(2).
TEST(FigureMovingTest, TheBandIsOneDeviationEitherSideOfTheMean) {
  auto results = random_results(2, "AB", 92);
  for (std::size_t i = 0; i < 2; ++i) {
    results[i].trials[kA].metrics.moving_rms_mm.assign(51, i == 0 ? 10.0 : 20.0);
    results[i].trials[kB].metrics.moving_rms_mm.assign(51, 40.0);
  }
  const Figure sut = figure_moving_rms(record_of(results));
  ASSERT_EQ(sut.panels.size(), 2u);
  const Series& band = sut.panels[0].series.at(0);
  ASSERT_EQ(band.kind, Kind::kBand);
  EXPECT_THAT(band.y_low, Each(testing::DoubleNear(15.0 - std::sqrt(50.0), 1e-12)));
  EXPECT_THAT(band.y_high, Each(testing::DoubleNear(15.0 + std::sqrt(50.0), 1e-12)));
  EXPECT_THAT(sut.panels[0].series.at(1).y, Each(15.0));
  EXPECT_EQ(band.x.back(), 50.0);
}

TEST(FigureMovingTest, AllConditionsHaveOneScaleThatHoldsEveryBand) {
  const Figure sut = figure_moving_dwell(record_of(random_results(4, "ABC", 93)));
  ASSERT_EQ(sut.panels.size(), 3u);
  for (const Panel& panel : sut.panels) {
    EXPECT_EQ(panel.y.high, sut.panels[0].y.high);
    EXPECT_LE(*std::ranges::max_element(panel.series.at(0).y_high), panel.y.high.value());
  }
}

TEST(FigureTracesTest, AreInMillimetresTwentyASecondAndWithinOneScale) {
  auto results = random_results(1, "AB", 94);
  results[0].trials[kB].cursor_m = {0.0, -0.2, 0.1};
  const Figure sut = figure_traces(record_of(results));
  ASSERT_EQ(sut.panels.size(), 2u);
  EXPECT_THAT(sut.panels[1].series.at(1).y, ElementsAre(0.0, -200.0, 100.0));
  EXPECT_THAT(sut.panels[0].series.at(0).x, ElementsAre(0.0, 0.05, 0.1));
  for (const Panel& panel : sut.panels) {
    EXPECT_LT(panel.y.low.value(), -200.0);
    EXPECT_EQ(panel.y.high.value(), -panel.y.low.value());
  }
}

TEST(FigureEstimateTest, TheBandHoldsItsDotsAndAnIntervalToZeroEndsTwentyDecibelsBelow) {
  const StudyRecord record = record_of(random_results(1, "A", 95));
  const auto& estimate = record.results[0].identification.estimate;
  const Panel sut = figure_estimate(record).panels.at(0);
  const Series& band = sut.series.at(0);
  const Series& dots = sut.series.at(1);
  ASSERT_EQ(band.x, dots.x);
  ASSERT_EQ(dots.x.size(), 75u);  // 0.2, 0.4, .. 15 Hz of 0 to 19.8 Hz
  for (std::size_t i = 0; i < dots.x.size(); ++i) {
    EXPECT_LE(band.y_low[i], dots.y[i]);
    EXPECT_GE(band.y_high[i], dots.y[i]);
    // Odd lines of the made estimate are uncertain by 150 %.
    if (estimate.magnitude_ci95[i + 1] > 1.0) {
      EXPECT_NEAR(band.y_low[i], dots.y[i] - 20.0, 1e-9);
    }
  }
}

TEST(FigureEstimateTest, AnUnstablePapersFitIsNotDrawn) {
  auto results = random_results(1, "A", 96);
  const std::size_t all = figure_estimate(record_of(results)).panels.at(0).series.size();
  results[0].identification.paper_unusable = "unstable";
  EXPECT_EQ(figure_estimate(record_of(results)).panels.at(0).series.size(), all - 1);
}

// Twelve at most, four in a row; places that a last row leaves over are blank.
TEST(FigureModelsTest, HasAMagnitudeAndAPhaseForEachOfTwelveSubjects) {
  for (const std::size_t subjects :
       {std::size_t{1}, std::size_t{4}, std::size_t{6}, std::size_t{30}}) {
    const Figure sut = figure_models(record_of(random_results(subjects, "A", 97)));
    const std::size_t shown = std::min<std::size_t>(subjects, 12);
    const auto drawn = std::ranges::count(sut.panels, false, &Panel::blank);
    EXPECT_EQ(static_cast<std::size_t>(drawn), 2 * shown) << subjects;
    EXPECT_EQ(sut.panels.size() % static_cast<std::size_t>(sut.columns), 0u) << subjects;
  }
}

TEST(FigureWrongModelsTest, SubjectsStandWorstFirstAndThoseWithoutAGainAreLeftOut) {
  StudyRecord record = with_wrong_models({0.9, -0.2, 0.5, 0.7});
  record.results[2].trials[kC].metrics.rms_error_mm = 49.0;
  record.analysis = analyse(record.results);
  const Panel sut = figure_wrong_models(record).panels.at(0);
  ASSERT_EQ(sut.series.size(), 1u);
  EXPECT_THAT(sut.series[0].x, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(sut.series[0].y,
              testing::Pointwise(testing::DoubleNear(1e-13), std::vector<double>{-0.2, 0.7, 0.9}));
}

}  // namespace
}  // namespace stillhand::study::figures_test
