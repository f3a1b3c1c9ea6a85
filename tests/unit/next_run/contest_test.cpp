// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/contest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/next_run/two_channels.hpp"

namespace stillhand::next_run::contest_test {

using testing::ElementsAre;

TEST(ContestTest, TheSameColumnIsATie) {
  const Contest sut = made::tied();
  EXPECT_NEAR(sut.before().twice_log_ratio(0, 1), 0.0, 1e-6);
  EXPECT_NEAR(sut.before().standard_error(0, 1), 0.0, 1e-6);
  EXPECT_EQ(sut.before().winner(), -1);
  EXPECT_EQ(sut.still_tied().size(), 2U);
}

// Eq. NR-13.  A motion of one frequency alone (half the rate): 2 and 3/(1 + 0.5) are one gain
// there.
TEST(ContestTest, RivalsThatExplainAsMuchMeet) {
  std::vector<Candidate> candidates{made::candidate("x"), made::candidate("z")};
  candidates[0].model.body.numerators = {{2.0, 0.0}};
  candidates[0].model.body.denominator = {1.0, 0.0};
  candidates[1].model.body.numerators = {{3.0, 0.0}};
  candidates[1].model.body.denominator = {1.0, -0.5};
  const Contest sut(candidates, diagnosis::Signals(made::measured(3300, 4, 1), {"u"}, "y"));
  EXPECT_EQ(sut.candidates()[0].model.body.denominator, sut.candidates()[1].model.body.denominator);
  EXPECT_EQ(sut.candidates()[0].model.body.numerators, sut.candidates()[1].model.body.numerators);
  EXPECT_EQ(sut.candidates()[0].cause().channels, std::vector<std::string>{"x"});
  EXPECT_EQ(sut.candidates()[1].cause().channels, std::vector<std::string>{"z"});
}

// Two seconds of a tank's record, a sample each four, hold none.
TEST(ContestTest, ASlowRecordingHasBlocksToo) {
  diagnosis::Measurement slow = made::measured(3300, 4, 1);
  slow.rate_hz = 0.25;
  std::vector<Candidate> candidates{made::candidate("x"), made::candidate("z")};
  for (Candidate& each : candidates) each.model.rate_hz = slow.rate_hz;
  const Contest sut(candidates, diagnosis::Signals(slow, {"u"}, "y"));
  EXPECT_EQ(sut.still_tied().size(), 2U);
}

// Eq. NR-3 in closed form.  The recording has 3200 samples behind its first second, the run 2000.
// d of the rival costs c^2 2000 for x, d^2 2000 for z, and (d - c)^2 3200 against the recording.
TEST(ContestTest, TheRivalIsFittedToBothRuns) {
  const Contest sut = made::tied(2.0);
  EXPECT_NEAR(sut.noise_rms(), 2.0, 0.1);  // of 3200 samples known to 1/sqrt 6400
  const double c = sut.candidates()[0].cause().coefficients[0] / sut.noise_rms();
  const double expected = c * c * (2000.0 + 2000.0 * 3200.0 / 5200.0);
  const auto run = made::measured(2100, 8, 2);
  // The edge of the first second is a sample of 2000.
  EXPECT_NEAR(sut.expected(run, 0).separation(0, 1), expected, 0.002 * expected);
  EXPECT_NEAR(sut.expected(run, 5).separation(0, 1), expected, 0.002 * expected);
  // What is left, d z - c x, has in each of nine blocks 200 q, in those of both edges 100 q: as 11
  // times their variance, 18000 q^2.  To it comes that of its product with the noise.
  const double q = c * c * (1.0 + 3200.0 / 5200.0 * 3200.0 / 5200.0);
  const double error = std::sqrt(18'000.0 * q * q + 4.0 * 2000.0 * q);
  EXPECT_NEAR(sut.expected(run, 0).standard_error(0, 1), error, 0.01 * error);
  // Both have an offset, a gain and the force of a channel, each determined by itself: ln(1 + N).
  for (const double price : sut.expected(run, 0).price) {
    EXPECT_NEAR(price, 3.0 * std::log(5201.0 / 3201.0), 0.01);
  }
}

TEST(ContestTest, ARunThatRepeatsTheTieSeparatesNothing) {
  EXPECT_NEAR(made::tied().expected(made::measured(2100, 4, 2), 5).separation(0, 1), 0.0, 1e-6);
}

// Eq. NR-6: Phi((36 - 2 x 12)/12) = Phi(1), and Phi((1 - 6)/2) = Phi(-2.5).
TEST(ContestTest, TheChanceIsThatOfANoncentralRatio) {
  const Contest sut = made::tied();
  Expected expected{Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 2),
                    Eigen::VectorXd::Zero(2)};
  expected.separation << 0.0, 36.0, 1.0, 0.0;
  expected.standard_error << 0.0, 12.0, 2.0, 0.0;
  EXPECT_NEAR(sut.chance(expected)(0, 1), 0.8413, 1e-3);
  EXPECT_NEAR(sut.chance(expected)(1, 0), 0.0062, 1e-3);
  EXPECT_NEAR(sut.probability_settled(expected), 0.5 * (0.8413 + 0.0062), 1e-3);
  // Evidence from few blocks has a larger scatter: Phi((36 - 2 x 20)/12).
  expected.standard_error(0, 1) = 20.0;
  EXPECT_NEAR(sut.chance(expected)(0, 1), 0.3694, 1e-3);
  // What the rival pays for its numbers in the run counts: Phi((36 + 16 - 40)/12).
  expected.price[1] = 16.0;
  EXPECT_NEAR(sut.chance(expected)(0, 1), 0.8413, 1e-3);
  EXPECT_NEAR(sut.chance(expected)(1, 0), 0.0, 1e-3);  // Phi((1 - 16 - 6)/2)
}

TEST(ContestTest, ARunInWhichTheyDifferLeavesTheTrueOne) {
  const Contest sut = made::tied();
  const Evidence after = sut.with(made::measured(2100, 8, 2));
  EXPECT_EQ(after.winner(), 0);
  EXPECT_THAT(after.left(), ElementsAre(0));
  // As expected, to four deviations of 2 sqrt(separation).
  const double expected = sut.expected(made::measured(2100, 8, 2), 5).separation(0, 1);
  EXPECT_NEAR(after.twice_log_ratio(0, 1), expected, 8.0 * std::sqrt(expected));
}

// Eq. NR-4: without noise the run adds what Eq. NR-3 expects.
TEST(ContestTest, ARunWithoutNoiseAddsTheSeparation) {
  const Contest sut = made::tied(2.0);
  auto run = made::measured(2100, 8, 2);
  run.channels.back().values = sut.prediction(0, run);
  const double separation = sut.expected(run, 20).separation(0, 1);
  EXPECT_NEAR(sut.with(run).twice_log_ratio(0, 1), separation, 1e-3 * separation);
}

// Eq. NR-5: 6, and two standard errors.
TEST(EvidenceTest, StrongEvidenceBeatsARival) {
  Evidence sut{Eigen::MatrixXd::Zero(2, 2), Eigen::MatrixXd::Zero(2, 2)};
  const auto settled = [&](double ratio, double error) {
    sut.twice_log_ratio(0, 1) = ratio;
    sut.standard_error(0, 1) = error;
    return sut.settled(0, 1);
  };
  EXPECT_FALSE(settled(5.9, 0.0));
  EXPECT_FALSE(settled(7.9, 4.0));
  EXPECT_TRUE(settled(8.0, 4.0));
  EXPECT_TRUE(settled(6.0, 3.0));
}

TEST(EvidenceTest, WhoBeatsAllOthersAloneWins) {
  Evidence sut{Eigen::MatrixXd{{0.0, 9.0, 5.0}, {-9.0, 0.0, -9.0}, {-5.0, 9.0, 0.0}},
               Eigen::MatrixXd::Zero(3, 3)};
  EXPECT_THAT(sut.left(), ElementsAre(0, 2));
  sut.twice_log_ratio(1, 2) = 9.0;  // which beats it, but is beaten
  EXPECT_THAT(sut.left(), ElementsAre(0));
  EXPECT_EQ(sut.winner(), -1);
  sut.twice_log_ratio(0, 2) = 6.0;
  EXPECT_EQ(sut.winner(), 0);
}

TEST(ContestTest, ARepetitionLeavesBoth) {
  const Contest sut = made::tied();
  EXPECT_THAT(sut.with(made::measured(2100, 4, 2)).left(), ElementsAre(0, 1));
}

// Eq. NR-2: of noise that is predictable from its past, errors without that past are not judged.
TEST(ContestTest, WhereTheNoiseModelBeginsNothingIsJudged) {
  diagnosis::Measurement recording = made::measured(3300, 4, 1);
  const std::vector<double> white = diagnosis::made::white(3300, 2);
  double slow = 0.0;
  for (std::size_t n = 0; n < white.size(); ++n) {
    recording.channels.back().values[n] += slow = 0.95 * slow + white[n];
  }
  const Contest sut({made::candidate("x"), made::candidate("z")},
                    diagnosis::Signals(recording, {"u"}, "y"));
  const Eigen::VectorXd left = sut.unmatched(0, 1, made::measured(2100, 8, 2), 0);
  // The first second is not judged either, 100 samples.
  EXPECT_EQ(left.head(101).norm(), 0.0);
  // x and z have steps of one size: so does what is left of them.
  EXPECT_GT(left.norm(), 0.0);
  EXPECT_LT(left.segment(101, 40).lpNorm<Eigen::Infinity>(),
            1.5 * left.tail(1000).lpNorm<Eigen::Infinity>());
}

// Eq. NR-2: a number that another one of the same model does already costs nothing, one of its own
// ln(1 + N).
TEST(ContestTest, ANumberThatTheRecordingDoesNotDetermineCostsNothing) {
  const auto recording = made::measured(3300, 8, 1);
  const auto evidence_against = [&](const char* second) {
    Candidate richer = made::candidate("x");
    richer.model.effects.push_back({"coupled_input", "static", {second}, {}, {0.0}});
    const Contest sut({made::candidate("x"), richer}, diagnosis::Signals(recording, {"u"}, "y"));
    return sut.before().twice_log_ratio(0, 1);
  };
  EXPECT_NEAR(evidence_against("x"), std::log(2.0), 0.1);
  EXPECT_NEAR(evidence_against("z"), std::log(3200.0), 4.0);  // what noise explains: chi^2 of 1
}

// Two candidates of one channel, one of them with a factor that the recording does not support.
TEST(ContestTest, WhatTheRecordingBeatsIsNotTied) {
  const Contest sut({made::candidate("x"), made::candidate("z")},
                    diagnosis::Signals(made::measured(3300, 8, 1), {"u"}, "y"));
  EXPECT_EQ(sut.before().winner(), 0);
  EXPECT_EQ(sut.still_tied().size(), 1U);
}

}  // namespace stillhand::next_run::contest_test
