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

// 800 samples: 800 ln(1.5) = 324 or 800 ln(1.001) = 0.8 for the error, ln(800) = 6.7 a number.
TEST(SelectionTest, AModelEarnsItsNumbersByWhatItExplains) {
  EXPECT_EQ(
      chosen_of({even("tone", 1.5, 1), even("drift", 1.0, 9), even("delay", 2.0, 1)}, 3.0, {}), 1u);
  EXPECT_EQ(chosen_of({even("drift", 1.0, 10), even("tone", 1.001, 1)}, 3.0, {}), 1u);
  EXPECT_EQ(chosen_of({even("tone", 1.0, 0), even("drift", 0.0, 12)}, 3.0, {}), 1u) << "no error";
  EXPECT_EQ(chosen_of({even("tone", 5.0, 3)}, 3.0, {}), 0u) << "the only one";
}

// An error 1 % larger and 0.993 of the gain in squares, (9 - 1.02)/(9 - 1), tie; from a square
// of 1.1 it has 0.08/0.1 of the gain.  Errors 3 % apart tie at most: squares 1.0609.
TEST(SelectionTest, TheSimplerWinsWhereItHasNearlyAllOfTheGain) {
  const auto chosen = [](double square, double current) {
    return chosen_of({even("drift", 1.0, 2), even("tone", square, 1)}, current, {});
  };
  EXPECT_EQ(chosen(1.02, 3.0), 1u);
  EXPECT_EQ(chosen(1.02, std::sqrt(1.1)), 0u);
  EXPECT_EQ(chosen(1.060, 10.0), 1u);
  EXPECT_EQ(chosen(1.062, 10.0), 0u);
}

// Larger than 1 by `mean` in the mean, and by t standard errors: +-d about it, t = mean sqrt 7/d.
std::vector<double> larger(double mean, double t) {
  std::vector<double> squares(kBlocks, 1.0 + mean);
  for (std::size_t b = 0; b < kBlocks; ++b) {
    squares[b] += (b % 2 == 0 ? 1.0 : -1.0) * mean * std::sqrt(7.0) / t;
  }
  return squares;
}

TEST(SelectionTest, WhatTheBlocksDoNotDistinguishTies) {
  const auto chosen = [](double t) {
    return chosen_of({even("drift", 1.0, 9), tried("tone", larger(0.1, t), 1)}, std::sqrt(1.2), {});
  };
  EXPECT_EQ(chosen(0.9), 1u);
  EXPECT_EQ(chosen(1.1), 0u);
}

// Below two standard errors rounding may have decided which of them has the smaller error.
TEST(SelectionTest, OfAsManyNumbersTheKindThatStandsFirstInTheListIsNamed) {
  const auto chosen = [](double t, const std::function<bool(const Trial&)>& worth_adding = {}) {
    return chosen_of({even("dead_zone", 1.0, 2), tried("hysteresis", larger(0.02, t), 2)},
                     std::sqrt(2.0), {}, worth_adding);
  };
  EXPECT_EQ(chosen(1.9), 1u);
  EXPECT_EQ(chosen(2.1), 0u);
  EXPECT_EQ(chosen(1.9, [](const Trial&) { return false; }), 0u)
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

TEST(SelectionTest, TiesNameOtherKindsOnceInTheirOrder) {
  const std::vector<Trial> sut{even("drift", 1.0, 2),  even("tone", 1.01, 3),
                               even("drift", 1.01, 4), even("delay", 1.02, 5),
                               even("tone", 1.0, 6),   even("bilinear", 2, 1)};
  EXPECT_THAT(tied_kinds(sut, 0, 3.0, {}), ElementsAre("tone", "delay"));
}

// p counts once for every candidate, or, from a fall of 15 % on, once.
TEST(SelectionTest, ASmallImprovementMustBeCertainForAllCandidates) {
  const auto sut = [](double rmse_ratio, double p, std::size_t candidates) {
    return worth_it({.rmse_ratio = rmse_ratio, .p = p}, {}, 0.01, candidates);
  };
  EXPECT_TRUE(sut(0.95, 0.9e-4, 10));
  EXPECT_FALSE(sut(0.95, 1.1e-4, 10));
  EXPECT_TRUE(sut(0.95, 1.1e-4, 9));
  EXPECT_FALSE(sut(0.995, 1e-12, 1)) << "half a percent, however certain";
  EXPECT_TRUE(sut(0.985, 1e-12, 1));
  EXPECT_TRUE(sut(0.80, 0.0099, 1000));
  EXPECT_FALSE(sut(0.80, 0.01, 1));
  EXPECT_FALSE(sut(1.2, 0.0, 1)) << "worse";
  EXPECT_FALSE(sut(std::numeric_limits<double>::quiet_NaN(), 0.0, 1));
  EXPECT_FALSE(worth_it({}, {}, 0.0, 1)) << "as it is where nothing was compared";
}

// Of eight blocks p is 2^-8 at best, too much for a hundred candidates.  Bursts need a fall of 15
// %, to a square of 0.7225, and what the rows show 1 %, to 0.9801.
TEST(SelectionTest, BurstsAndWhatTheRowsShowNeedNoSigns) {
  const auto added = [&](double drift, const char* kind, double square) {
    std::vector<Trial> sut{even("drift", drift, 1), even(kind, square, 1)};
    sut[1].model.effects[0].form = "clip above";
    return added_of(sut, even("drift", 1.0, 1).held_out, 0.01, 100, {});
  };
  EXPECT_EQ(added(0.9, "output_saturation", 0.98), 1u) << "the drift may be chance";
  EXPECT_EQ(added(0.9, "output_saturation", 0.981), 2u) << "none";
  EXPECT_EQ(added(0.9, "transients", 0.722), 1u);
  EXPECT_EQ(added(0.9, "transients", 0.723), 2u);
  EXPECT_EQ(added(0.722, "tone", 0.9), 0u) << "15 % need no more than p";
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
