// SPDX-License-Identifier: Apache-2.0
// The choice among models that were tried, Eq. DG-17 and DG-50, on errors that are made up.
#include "services/core/diagnosis/selection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::selection_test {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kBlocks = 8;
constexpr double kWeight = 100.0;

// Mean square of every block, and how many coefficients the effect has.
Trial tried(const char* kind, const std::vector<double>& mean_squares, std::size_t numbers) {
  Trial trial;
  Effect effect{kind, "", {}, {}, {}};
  effect.coefficients.assign(numbers, 1.0);
  trial.model = made::model_of(made::two_pole_body(), {effect});
  trial.held_out.finite = true;
  double sum = 0.0;
  for (const double square : mean_squares) {
    trial.held_out.squares.push_back(square * kWeight);
    trial.held_out.weights.push_back(kWeight);
    sum += square / static_cast<double>(mean_squares.size());
  }
  trial.rmse = std::sqrt(sum);
  return trial;
}

Trial even(const char* kind, double mean_square, std::size_t numbers) {
  return tried(kind, std::vector<double>(kBlocks, mean_square), numbers);
}

// p of 99 surrogates: one gives as much, or none does.
TEST(SelectionTest, WhatSurrogatesGiveAsWellIsNotChosen) {
  std::vector<Trial> sut{even("delay", 1.0, 1), even("drift", 2.0, 1)};
  const HeldOut current = even("delay", 4.0, 1).held_out;
  sut[0].surrogate_p = 0.01;
  EXPECT_EQ(chosen_of(sut, 2.0, {}), 0u);
  EXPECT_TRUE(is_worth_adding(sut[0], current, 0.005, 1, {}));
  sut[0].surrogate_p = 0.02;
  EXPECT_EQ(chosen_of(sut, 2.0, {}), 1u);
  EXPECT_FALSE(is_worth_adding(sut[0], current, 0.005, 1, {}));
  EXPECT_THAT(tied_kinds(sut, 1, 2.0, {}), IsEmpty());
}

// 800 samples: ln(1.5) 800 = 324 for the error, ln(800) = 6.7 a number.
TEST(SelectionTest, AModelThatExplainsMoreEarnsItsNumbers) {
  const std::vector<Trial> sut{even("tone", 1.5, 1), even("drift", 1.0, 9), even("delay", 2.0, 1)};
  EXPECT_EQ(chosen_of(sut, 3.0, {}), 1u);
}

// 800 ln(1.001) = 0.8 for the error, nine numbers more cost 60.
TEST(SelectionTest, NumbersThatExplainNothingCostMoreThanTheyBring) {
  const std::vector<Trial> sut{even("drift", 1.0, 10), even("tone", 1.001, 1)};
  EXPECT_EQ(chosen_of(sut, 3.0, {}), 1u);
}

// An error 1 % larger and 0.993 of the gain in squares, (9 - 1.02)/(9 - 1): a tie.
TEST(SelectionTest, TheSimplerWinsWhereItHasNearlyAllOfTheGain) {
  const std::vector<Trial> sut{even("drift", 1.0, 2), even("tone", 1.02, 1)};
  EXPECT_EQ(chosen_of(sut, 3.0, {}), 1u);
  // From a square of 1.1 the simpler one has 0.08/0.1 of the gain.
  EXPECT_EQ(chosen_of(sut, std::sqrt(1.1), {}), 0u);
}

// Errors 3 % apart tie at most: squares 1.0609.
TEST(SelectionTest, AnErrorThatIsClearlyLargerIsNoTie) {
  const auto chosen = [](double square) {
    return chosen_of({even("drift", 1.0, 2), even("tone", square, 1)}, 10.0, {});
  };
  EXPECT_EQ(chosen(1.060), 1u);
  EXPECT_EQ(chosen(1.062), 0u);
}

// Differences +-0.6 with a mean of 0.1: t = 0.1/(0.64/sqrt(8)) = 0.44 < 1.
TEST(SelectionTest, WhatTheBlocksDoNotDistinguishTies) {
  std::vector<double> uneven(kBlocks, 1.0);
  for (std::size_t b = 0; b < kBlocks; ++b) uneven[b] += b % 2 == 0 ? 0.7 : -0.5;
  const std::vector<Trial> sut{even("drift", 1.0, 9), tried("tone", uneven, 1)};
  EXPECT_EQ(chosen_of(sut, std::sqrt(1.2), {}), 1u);
}

// As above, t = 0.44 < 2: rounding may have decided which of them has the smaller error.
TEST(SelectionTest, OfAsManyNumbersTheKindThatStandsFirstInTheListIsNamed) {
  std::vector<double> uneven(kBlocks, 1.0);
  for (std::size_t b = 0; b < kBlocks; ++b) uneven[b] += b % 2 == 0 ? 0.7 : -0.5;
  const std::vector<Trial> sut{even("dead_zone", 1.0, 2), tried("hysteresis", uneven, 2)};
  EXPECT_EQ(chosen_of(sut, std::sqrt(1.2), {}), 1u);
  EXPECT_EQ(chosen_of(sut, std::sqrt(1.2), {}, [](const Trial&) { return false; }), 0u)
      << "only if it is worth adding itself";
}

TEST(SelectionTest, AModelThatRanAwayIsNeverChosen) {
  for (const double error :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    std::vector<Trial> sut{even("tone", 1.0, 0), even("drift", 1.0, 5)};
    sut[0].rmse = error;
    EXPECT_EQ(chosen_of(sut, 3.0, {}), 1u);
    EXPECT_THAT(tied_kinds(sut, 1, 3.0, {}), IsEmpty());
  }
}

TEST(SelectionTest, AnErrorBeyondAnyTestIsNoImprovement) {
  const HeldOut far = even("drift", 1e110, 1).held_out;
  const HeldOut near = even("drift", 1.0, 1).held_out;
  EXPECT_EQ(compared(near, far).p, 1.0);
  EXPECT_FALSE(worth_it(compared(near, far), {}, 0.0, 1));
}

TEST(SelectionTest, AModelWithoutErrorIsChosen) {
  const std::vector<Trial> sut{even("tone", 1.0, 0), even("drift", 0.0, 12)};
  EXPECT_EQ(chosen_of(sut, 3.0, {}), 1u);
}

TEST(SelectionTest, OneTrialIsTheChoice) {
  EXPECT_EQ(chosen_of({even("tone", 5.0, 3)}, 3.0, {}), 0u);
}

TEST(SelectionTest, TiesNameOtherKindsOnceInTheirOrder) {
  const std::vector<Trial> sut{even("drift", 1.0, 2),  even("tone", 1.01, 3),
                               even("drift", 1.01, 4), even("delay", 1.02, 5),
                               even("tone", 1.0, 6),   even("bilinear", 2, 1)};
  EXPECT_THAT(tied_kinds(sut, 0, 3.0, {}), ElementsAre("tone", "delay"));
}

Comparison of(double rmse_ratio, double p) { return {.rmse_ratio = rmse_ratio, .p = p}; }

// 0.01 is below the fall of a large improvement, 0.15: p counts once for every candidate.
TEST(SelectionTest, ASmallImprovementMustBeCertainForAllCandidates) {
  const SearchOptions options;
  EXPECT_TRUE(worth_it(of(0.95, 0.9e-4), options, 0.01, 10));
  EXPECT_FALSE(worth_it(of(0.95, 1.1e-4), options, 0.01, 10));
  EXPECT_TRUE(worth_it(of(0.95, 1.1e-4), options, 0.01, 9));
  EXPECT_FALSE(worth_it(of(0.995, 1e-12), options, 0.01, 1)) << "half a percent, however certain";
  EXPECT_TRUE(worth_it(of(0.985, 1e-12), options, 0.01, 1));
}

TEST(SelectionTest, ALargeImprovementIsJudgedOnce) {
  const SearchOptions options;
  EXPECT_TRUE(worth_it(of(0.80, 0.0099), options, 0.01, 1000));
  EXPECT_FALSE(worth_it(of(0.80, 0.01), options, 0.01, 1));
}

TEST(SelectionTest, AWorseModelIsWorthNothing) {
  EXPECT_FALSE(worth_it(of(1.2, 0.0), {}, 0.01, 1));
  EXPECT_FALSE(worth_it(of(std::numeric_limits<double>::quiet_NaN(), 0.0), {}, 0.01, 1));
  EXPECT_FALSE(worth_it({}, {}, 0.0, 1)) << "as it is where nothing was compared";
}

// 1e-9 of the output's deviation, 2.
TEST(SelectionTest, RoundingIsMeasuredByTheOutput) {
  std::vector<double> y(400);
  for (std::size_t n = 0; n < y.size(); ++n) y[n] = n % 2 == 0 ? 7.0 : 3.0;
  const Signals signals(
      made::measurement_of({{"u", "V", made::white(400, 1)}, {"y", "N", std::move(y)}}), {"u"},
      "y");
  EXPECT_TRUE(is_rounding(1.9e-9, signals));
  EXPECT_FALSE(is_rounding(2.1e-9, signals));
  EXPECT_TRUE(is_rounding(0.0, signals));
}

}  // namespace stillhand::diagnosis::selection_test
