// SPDX-License-Identifier: Apache-2.0
// Causes of the spread between people: draws, ranking and signatures, Eq. SU-23 to SU-25, on made
// responses whose answer is known.
#include "apps/study/explain/spread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "apps/study/subjects/subject_session.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/files/settings/yaml_text.hpp"

namespace stillhand::study::spread_test {
namespace {

using statistics::mean;
using statistics::standard_deviation;

session::PlannedTrial trial_of(TrialPhase phase, std::int64_t number, bool cancellation = false) {
  session::PlannedTrial out{};
  out.trial.phase = phase;
  out.trial.number = number;
  out.cancellation = cancellation;
  return out;
}

session::CoreConfigs changed(const PersonalSpread& spread, std::int64_t person,
                             const session::PlannedTrial& planned) {
  session::CoreConfigs out;
  PersonalTrials(spread, 7, person).change(planned, out);
  return out;
}

// Of 500 people, a logarithm over its unchanged value.
std::vector<double> drawn(const PersonalSpread& spread, const session::PlannedTrial& planned,
                          const auto& quantity) {
  std::vector<double> out;
  for (std::int64_t person = 0; person < 500; ++person) {
    out.push_back(
        std::log(quantity(changed(spread, person, planned)) / quantity(session::CoreConfigs{})));
  }
  return out;
}

const auto kGrip = [](const session::CoreConfigs& c) { return c.rig.body.grip_stiffness_n_m; };
const auto kShoulder = [](const session::CoreConfigs& c) {
  return c.rig.body.shoulder_stiffness_n_m;
};
const auto kCrossover = [](const session::CoreConfigs& c) { return c.human_operator.crossover_hz; };

TEST(PersonalSpreadTest, AsItStandsNothingDiffers) {
  for (const auto phase : {TrialPhase::kPegged, TrialPhase::kTracking}) {
    const session::CoreConfigs sut = changed({}, 3, trial_of(phase, 2, true));
    EXPECT_EQ(settings::yaml_text(sut.rig), settings::yaml_text(rig::RigConfig{}));
    EXPECT_EQ(settings::yaml_text(sut.human_operator),
              settings::yaml_text(human_operator::CrossoverConfig{}));
  }
}

// The cut at 2.5 takes 5 % of a deviation; 500 draws leave 3 %.
TEST(PersonalSpreadTest, TheHandOnThePegDiffersByAFactorOfThePersonsOwn) {
  const auto pegged = trial_of(TrialPhase::kPegged, 0);
  const auto grip = drawn({.pegged_grip = 0.3}, pegged, kGrip);
  EXPECT_NEAR(standard_deviation(grip), 0.95 * 0.3, 0.1 * 0.3);
  EXPECT_NEAR(mean(grip), 0.0, 0.05);
  const auto both = drawn({.pegged_stiffness = 0.2}, pegged, kGrip);
  const auto shoulder = drawn({.pegged_stiffness = 0.2}, pegged, kShoulder);
  for (std::size_t i = 0; i < both.size(); ++i) EXPECT_NEAR(both[i], shoulder[i], 1e-12);
  const auto tracking = drawn({.pegged_stiffness = 0.2, .pegged_grip = 0.3},
                              trial_of(TrialPhase::kTracking, 1), kGrip);
  EXPECT_EQ(standard_deviation(tracking), 0.0);
}

TEST(PersonalSpreadTest, SkillGrowsAboutTheSecondTrialAndTheMotorsIsForTheMotor) {
  const PersonalSpread learning{.learning = 0.1};
  const auto first = drawn(learning, trial_of(TrialPhase::kTracking, 1), kCrossover);
  const auto third = drawn(learning, trial_of(TrialPhase::kTracking, 3), kCrossover);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_NEAR(first[i], -third[i], 1e-12);
  EXPECT_NEAR(standard_deviation(third), 0.095, 0.01);
  const PersonalSpread motor{.motor_skill = 0.2};
  EXPECT_EQ(standard_deviation(drawn(motor, trial_of(TrialPhase::kTracking, 1), kCrossover)), 0.0);
  EXPECT_NEAR(
      standard_deviation(drawn(motor, trial_of(TrialPhase::kTracking, 1, true), kCrossover)), 0.19,
      0.02);
}

TEST(PersonalSpreadTest, AVisitRepeatsThePersonAndNotTheTrial) {
  const PersonalSpread spread{.motor_skill = 0.2, .motor_gain = 0.1};
  PersonalSpread again = spread;
  again.visit = 1;
  const auto planned = trial_of(TrialPhase::kTracking, 2, true);
  EXPECT_EQ(kCrossover(changed(spread, 4, planned)), kCrossover(changed(again, 4, planned)));
  EXPECT_NE(PersonalTrials(spread, 7, 4).loop_seed(planned, 1),
            PersonalTrials(again, 7, 4).loop_seed(planned, 1));
  const auto pegged = trial_of(TrialPhase::kPegged, 0);
  EXPECT_EQ(PersonalTrials(spread, 7, 4).loop_seed(pegged, 1),
            PersonalTrials(again, 7, 4).loop_seed(pegged, 1));
  PersonalSpread by_trial{.trial_skill = 0.1};
  const double once = kCrossover(changed(by_trial, 4, planned));
  by_trial.visit = 1;
  EXPECT_NE(kCrossover(changed(by_trial, 4, planned)), once);
}

// Trials of five seconds: what differs on the peg alone changes the model, and so C alone.
TEST(PersonalSpreadTest, APeggedHandThatDiffersChangesCAlone) {
  StudyOptions options;
  options.protocol.conditions = session::parse_conditions("A,B,C", session::kStudyConditions);
  options.protocol.trial_s = 5.0;
  options.protocol.identify_s = 10.0;
  options.personal.emplace();
  const SubjectResult plain = run_subject(options, 0);
  options.personal->pegged_stiffness = 0.3;
  const SubjectResult other = run_subject(options, 0);
  for (const Condition same : {kA, kB}) {
    EXPECT_EQ(plain.trials.at(same).metrics.rms_error_mm,
              other.trials.at(same).metrics.rms_error_mm);
  }
  EXPECT_NE(plain.trials.at(kC).metrics.rms_error_mm, other.trials.at(kC).metrics.rms_error_mm);
  options.personal->visit = 1;
  const SubjectResult visit = run_subject(options, 0);
  EXPECT_EQ(visit.identification.fit.numerator, other.identification.fit.numerator);
  EXPECT_NE(visit.trials.at(kB).metrics.rms_error_mm, other.trials.at(kB).metrics.rms_error_mm);
}

TEST(SpreadCausesTest, EachChangesTheOptionsAndHasASource) {
  for (const Cause& cause : spread_causes()) {
    EXPECT_FALSE(cause.source.empty()) << cause.name;
    EXPECT_TRUE(std::ranges::is_sorted(cause.grid)) << cause.name;
    EXPECT_EQ(std::ranges::count(cause.grid, cause.none), 1) << cause.name;
    StudyOptions base;
    base.canceller = "paper";
    base.personal.emplace();
    StudyOptions options = base;
    cause.apply(options, cause.most);
    EXPECT_NO_THROW(validate(options.population, "population")) << cause.name;
    const bool differs =
        std::memcmp(&*options.personal, &*base.personal, sizeof(PersonalSpread)) != 0 ||
        options.canceller != base.canceller ||
        settings::yaml_text(options.population) != settings::yaml_text(base.population);
    EXPECT_TRUE(differs) << cause.name;
  }
}

// People with the paper's means and a tenth of its deviations; three causes act on C.
class MadeSpread {
 public:
  MadeSpread() {
    const PaperTables paper = paper_tables(5.5);
    const Deviations deviations = paper_deviations(paper);
    signal::Gaussian normal(1, 2);
    for (int i = 0; i < 300; ++i) {
      Response one;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        one.metrics[k] = paper.values[row];
        one.metrics[3 + k] =
            one.metrics[k] + paper.values[3 + row] + 0.1 * deviations[k] * normal();
        one.metrics[6 + k] =
            one.metrics[3 + k] + paper.values[6 + row] + 0.1 * deviations[3 + k] * normal();
      }
      responses_.chain.push_back(one);
    }
    const char* const names[]{"spreads", "shifts", "nothing"};
    for (std::size_t c = 0; c < 3; ++c) {
      causes_[c].name = names[c];
      causes_[c].grid = {0.0, 1.0};
      causes_[c].most = 1.0;
      auto at = responses_.chain;
      for (Response& one : at) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (c == 0) one.metrics[6 + k] += deviations[3 + k] * normal();
          if (c == 1) one.metrics[6 + k] += 2.0 * deviations[3 + k] * (1.0 + normal());
        }
      }
      responses_.causes.push_back({&causes_[c], {responses_.chain, at}});
    }
  }

  Cause causes_[3];
  SpreadResponses responses_;
};

TEST(RankSpreadTest, WhatSpreadsPeopleAndKeepsTheMeansComesFirst) {
  const MadeSpread made;
  const Spread sut = rank_spread(made.responses_, paper_tables(5.5));
  for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(sut.chain.over_paper[k], 0.1, 0.02);
  EXPECT_EQ(sut.chain.given, 0.0);
  ASSERT_EQ(sut.ranked.size(), 3u);
  EXPECT_EQ(sut.ranked[0].name, "spreads");
  EXPECT_NEAR(sut.ranked[0].given, 1.0, 0.1);
  EXPECT_TRUE(sut.ranked[0].holds);
  EXPECT_LT(sut.ranked[0].low, sut.ranked[0].given);
  // Seven standard errors off at the end, one at a seventh of it.
  EXPECT_EQ(sut.ranked[1].name, "shifts");
  EXPECT_FALSE(sut.ends[1].holds);
  EXPECT_LT(sut.ranked[1].given, 0.4);
  EXPECT_EQ(sut.ranked[2].given, 0.0);
  EXPECT_EQ(sut.combination.causes.front().first, 0u);
}

TEST(RankSpreadTest, DeviationsOfTheTablesComeBack) {
  const Deviations sut = paper_deviations(paper_tables(5.5));
  EXPECT_NEAR(sut[3], 5.9, 0.05);
  EXPECT_NEAR(sut[4], 0.042, 0.0005);
  EXPECT_NEAR(sut[5], 0.039, 0.0005);
}

TEST(SignaturesTest, PeopleNeededByHand) {
  // z = 1.959964 + 0.841621; atanh(0.5) = 0.549306, ln 2 = 0.693147.
  EXPECT_NEAR(people_needed(0, 0.5, 0.0), 3.0 + std::pow(2.801585 / 0.549306, 2), 1e-4);
  EXPECT_NEAR(people_needed(5, 2.0, 1.0), 1.0 + 0.5 * std::pow(2.801585 / 0.693147, 2), 1e-4);
  EXPECT_TRUE(std::isinf(people_needed(0, 0.3, 0.3)));
  const SignatureValues one{0.5, 0.0, 0.0, 0.0, 0.0, 2.0, 10.0, 1.0};
  const SignatureValues other{0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 10.0, 1.0};
  EXPECT_EQ(tells_apart(one, other).first, 5u);
}

TEST(SignaturesTest, AreThoseOfThePeople) {
  std::vector<Response> first(5);
  std::vector<Response> second(5);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto x = static_cast<double>(i);
    first[i].metrics[3] = 50.0 + x;
    first[i].metrics[6] = 40.0 - x;  // B-C: 10 + 2 x
    first[i].metrics[8] = 0.01 * x;
    second[i].metrics[3] = 60.0;
    second[i].metrics[6] = 50.0 - 3.0 * x;
    second[i].metrics[8] = -0.02 * x;
    first[i].observed = {.counterforce_delay_s = 0.001 * x,
                         .cancelled_share = -x,
                         .motor_over_feedthrough = std::exp(0.1 * x),
                         .c_after_b = i % 2 == 0 ? 1.0 : -1.0};
  }
  const double deviation = std::sqrt(2.5);  // of 0 to 4
  const SignatureValues by_hand{1.0, -1.0, -1.0, 0.0, -1.0, 0.1 * deviation, deviation, 1.0};
  EXPECT_THAT(signatures_of(first, second),
              testing::Pointwise(testing::DoubleNear(1e-12), by_hand));
}

}  // namespace
}  // namespace stillhand::study::spread_test
