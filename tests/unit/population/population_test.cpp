// SPDX-License-Identifier: Apache-2.0
// Subjects of a population: Eq. SU-1 and SU-2.
#include "services/core/population/population.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <type_traits>
#include <vector>

#include "services/core/rig/rig.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/files/settings/load.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::population::population_test {
namespace {

std::vector<double> drawn(const Population& population, int count, double (*of)(const Subject&)) {
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) out.push_back(of(draw_subject(population, 7, i)));
  return out;
}

// 4000 draws: the mean's standard error is cv / 63, the deviation's 1.1 %.  Cutting at 2.5 takes
// 4.5 % off the deviation and, the lognormal being skewed, cv^2 * 0.04 off the mean.
TEST(PopulationTest, DrawsHaveTheMeanAndTheSpreadOfTheFile) {
  Population population;
  population.grip_stiffness_cv = 0.3;
  const auto values =
      drawn(population, 4000, [](const Subject& s) { return s.body.grip_stiffness_n_m; });
  const double mean = statistics::mean(values);
  EXPECT_NEAR(mean / population.grip_stiffness_n_m, 1.0, 4.0 * 0.3 / 63.0 + 0.3 * 0.3 * 0.1);
  EXPECT_NEAR(statistics::standard_deviation(values) / mean, 0.3 * 0.93, 0.3 * 0.07);
}

TEST(PopulationTest, NothingDrawnIsEverNegativeAndNothingFarOut) {
  Population population;
  population.shoulder_stiffness_cv = 0.6;
  const double s = std::sqrt(std::log1p(0.36));
  for (const double value :
       drawn(population, 2000, [](const Subject& a) { return a.body.shoulder_stiffness_n_m; })) {
    EXPECT_GT(value, population.shoulder_stiffness_n_m * std::exp(-2.5 * s - 0.5 * s * s) * 0.999);
    EXPECT_LT(value, population.shoulder_stiffness_n_m * std::exp(2.5 * s - 0.5 * s * s) * 1.001);
  }
}

TEST(PopulationTest, ASubjectDoesNotDependOnHowManyOthersThereAre) {
  const Population population;
  const Subject alone = draw_subject(population, 3, 5);
  draw_subject(population, 3, 4);
  const Subject again = draw_subject(population, 3, 5);
  EXPECT_EQ(alone.body.trunk_mass_kg, again.body.trunk_mass_kg);
  EXPECT_EQ(alone.who.delay_s, again.who.delay_s);
  EXPECT_NE(alone.body.trunk_mass_kg, draw_subject(population, 3, 6).body.trunk_mass_kg);
  EXPECT_NE(alone.body.trunk_mass_kg, draw_subject(population, 4, 5).body.trunk_mass_kg);
}

TEST(PopulationTest, TheArmIsNoSofterWhenItTracksThanWhenItIdles) {
  Population wide;
  wide.cocontraction_cv = 1.0;
  const auto factors =
      drawn(wide, 100, [](const Subject& s) { return s.body.cocontraction_stiffness_factor; });
  EXPECT_EQ(std::ranges::min(factors), 1.0);
  EXPECT_EQ(std::ranges::max(factors), 4.0);  // the range of the rig's setting
}

// Oracle: a constant force on the free stick until it rests.  K of Eq. SU-2 is the series
// stiffness of seat, shoulder and grip, so x = f / K; Coulomb friction, 0.2 N of 5 N, is off.
TEST(PopulationTest, TheLearntStiffnessIsWhatTheRigAnswersWith) {
  const Subject subject = mean_subject({});
  rig::RigConfig config;
  config.body = subject.body;
  config.body.neuromuscular = {};
  config.stick.coulomb_friction_n = 0.0;
  rig::Rig rig(config);
  const rig::RigInput input{.command_valid = true, .operator_valid = true, .operator_force_n = 5.0};
  double theta_rad = 0.0;
  for (int n = 0; n < 10000; ++n) theta_rad = rig.step(input).truth.theta_rad;
  const double moved_m = theta_rad * config.stick.lever_m;
  EXPECT_NEAR(5.0 / moved_m, subject.who.arm.effective_stiffness_n_m,
              1e-4 * subject.who.arm.effective_stiffness_n_m);
}

// Largest relative distance between the numbers of two settings.
struct Numbers {
  std::vector<double> values;
  void operator()(const char*, double value, Range, const char*) { values.push_back(value); }
  void operator()(const char*, std::int64_t, Range, const char*) {}
  template <typename Group>
  void group(const char*, const Group& fields) {
    Group::fields(*this, fields);
  }
};

template <typename Config>
std::vector<double> numbers(const Config& config) {
  Numbers visit;
  Config::fields(visit, config);
  return visit.values;
}

TEST(PopulationTest, RigAndOperatorHaveTheMeanSubjectsHandByDefault) {
  const Subject mean = mean_subject({});
  using testing::DoubleNear;
  const auto near = [](const std::vector<double>& expected) {
    std::vector<testing::Matcher<double>> all;
    all.reserve(expected.size());
    for (const double value : expected) all.push_back(DoubleNear(value, 1e-3 * std::abs(value)));
    return testing::ElementsAreArray(all);
  };
  EXPECT_THAT(numbers(rig::BodyConfig{}), near(numbers(mean.body)));
  EXPECT_THAT(numbers(human_operator::CrossoverConfig{}), near(numbers(mean.who)));
}

// Half of the way to the top of each range.
struct Raised {
  void operator()(const char*, double& value, Range range, const char*) const {
    value = 0.5 * (value + range.max);
  }
};

// Of the body the eleven numbers of masses, springs, dampers and co-contraction, and nine of its
// nerves; of the operator seven, and the three of the feel.
TEST(PopulationTest, EveryNumberOfTheFileReachesTheSubject) {
  Population raised;
  Population::fields(Raised{}, raised);
  const Subject sut = mean_subject(raised);
  const auto changed = [](const auto& config) {
    const auto before = numbers(std::decay_t<decltype(config)>{}), after = numbers(config);
    return std::inner_product(before.begin(), before.end(), after.begin(), 0, std::plus{},
                              std::not_equal_to{});
  };
  EXPECT_EQ(changed(sut.body), 11 + 9);
  EXPECT_EQ(changed(sut.who), 7 + 3);
}

TEST(PopulationTest, ANegativeStiffnessIsRefusedByName) {
  Population population;
  population.grip_stiffness_n_m = -2400.0;
  EXPECT_THAT(support::refusal([&] { draw_subject(population, 1, 0); }),
              testing::HasSubstr("population.grip_stiffness_n_m"));
}

TEST(PopulationTest, AMisspeltKeyIsNamedWithTheRightOne) {
  const std::string said = support::refusal([&] {
    settings::load_text<Population>("shoulder_stifness_n_m: 900\n", "population", "people.yaml");
  });
  EXPECT_THAT(said, testing::HasSubstr("people.yaml:1"));
  EXPECT_THAT(said, testing::HasSubstr("shoulder_stiffness_n_m"));
}

}  // namespace
}  // namespace stillhand::population::population_test
