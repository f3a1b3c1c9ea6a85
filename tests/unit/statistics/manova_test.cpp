// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/manova.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <string>

#include "tests/golden/statistics/exact_lambda.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/statistics_golden.hpp"

namespace stillhand::statistics::manova_test {
namespace {

namespace golden = stillhand::golden::statistics;
using Eigen::MatrixXd;
using support::agrees;
using support::golden_trials;

void expect_equal(const char* effect, const MultivariateTest& sut, const golden::EffectRow& want) {
  SCOPED_TRACE(effect);
  EXPECT_TRUE(agrees(sut.wilks_lambda, want.lambda));
  EXPECT_TRUE(agrees(sut.wilks.f, want.wilks_f));
  EXPECT_TRUE(agrees(sut.wilks.numerator_df, want.wilks_1));
  EXPECT_TRUE(agrees(sut.wilks.denominator_df, want.wilks_2));
  EXPECT_TRUE(agrees(sut.wilks.p, want.wilks_p));
  EXPECT_TRUE(agrees(sut.pillai_trace, want.trace));
  EXPECT_TRUE(agrees(sut.pillai.f, want.pillai_f));
  EXPECT_TRUE(agrees(sut.pillai.numerator_df, want.pillai_1));
  EXPECT_TRUE(agrees(sut.pillai.denominator_df, want.pillai_2));
  EXPECT_TRUE(agrees(sut.pillai.p, want.pillai_p));
}

// One to five metrics, two to six conditions, one and three replicates, p down to 1e-54.
TEST(ManovaTest, EqualsR) {
  for (const auto& want : golden::kManova) {
    SCOPED_TRACE("set " + std::to_string(want.set) + ", conditions " +
                 std::to_string(want.conditions) + ", replicates " +
                 std::to_string(want.replicates) + ", metrics " + std::to_string(want.metrics));
    const Manova sut = two_way_manova(
        golden_trials(want.set).part(want.subjects, want.conditions, want.replicates, want.metrics),
        {want.subjects, want.conditions, want.replicates});
    EXPECT_EQ(sut.error_df, want.error_df);
    expect_equal("condition", sut.condition, want.condition);
    expect_equal("subject", sut.subject, want.subject);
    ASSERT_EQ(sut.interaction.has_value(), want.interaction.has_value());
    if (want.interaction) expect_equal("interaction", *sut.interaction, *want.interaction);
  }
}

TEST(ManovaTest, LambdaEqualsThatInExactArithmetic) {
  for (const auto& want : golden::kExactLambdas) {
    const Manova sut = two_way_manova(
        golden_trials(want.set).part(want.subjects, want.conditions, 1, want.metrics),
        {want.subjects, want.conditions, 1});
    EXPECT_TRUE(agrees(sut.condition.wilks_lambda, want.condition));
    EXPECT_TRUE(agrees(sut.subject.wilks_lambda, want.subject));
  }
}

// Of two conditions both statistics are Hotelling's T^2 and so the same F, even with no more
// degrees of freedom of the error than metrics.
TEST(ManovaTest, TwoConditionsGiveOneF) {
  const MatrixXd trials = golden_trials(2).part(6, 2, 1, 5);
  const MultivariateTest sut = two_way_manova(trials, {6, 2, 1}).condition;
  EXPECT_TRUE(agrees(sut.wilks.f, sut.pillai.f));
  EXPECT_TRUE(agrees(sut.wilks.p, sut.pillai.p));
  // T^2 = n m' S^-1 m of the six differences, F = T^2 (n - p) / ((n - 1) p).
  MatrixXd difference(6, 5);
  for (Eigen::Index s = 0; s < 6; ++s)
    difference.row(s) = trials.row(2 * s) - trials.row(2 * s + 1);
  const Eigen::RowVectorXd mean = difference.colwise().mean();
  const MatrixXd centred = difference.rowwise() - mean;
  const Eigen::VectorXd solved =
      (centred.transpose() * centred / 5.0).ldlt().solve(mean.transpose());
  const double t_squared = 6.0 * mean.dot(solved);
  // The oracle squares the condition number (about 1e4 here) where the code doesn't.
  EXPECT_NEAR(sut.wilks.f / (t_squared * (6.0 - 5.0) / (5.0 * 5.0)), 1.0, 1e-7);
}

TEST(ManovaTest, ReplicatesAveragedGiveTheTestAgainstTheInteraction) {
  // Means of cells know the interaction as their only error, so Lambda of the condition must be
  // det(H_i) / det(H_i + H_c) of the full decomposition.
  const MatrixXd trials = golden_trials(2).part(9, 4, 3, 2);
  MatrixXd cells(36, 2);
  for (Eigen::Index i = 0; i < 36; ++i) cells.row(i) = trials.middleRows(3 * i, 3).colwise().mean();
  const Manova sut = two_way_manova(cells, {9, 4, 1});
  MatrixXd residual = cells, condition = MatrixXd::Zero(36, 2);
  const Eigen::RowVectorXd grand = cells.colwise().mean();
  for (Eigen::Index c = 0; c < 4; ++c) {
    Eigen::RowVectorXd of_condition = Eigen::RowVectorXd::Zero(2);
    for (Eigen::Index s = 0; s < 9; ++s) of_condition += cells.row(4 * s + c) / 9.0;
    for (Eigen::Index s = 0; s < 9; ++s) {
      condition.row(4 * s + c) = of_condition - grand;
      residual.row(4 * s + c) -= of_condition + cells.middleRows(4 * s, 4).colwise().mean() - grand;
    }
  }
  const MatrixXd error = residual.transpose() * residual;
  const MatrixXd total = error + condition.transpose() * condition;
  EXPECT_TRUE(agrees(sut.condition.wilks_lambda, error.determinant() / total.determinant()));
  EXPECT_FALSE(sut.interaction.has_value());
}

TEST(ManovaTest, UnitsAndMixturesOfMetricsDoNotMatter) {
  const MatrixXd trials = golden_trials(1).values;
  Eigen::Matrix3d mixture;
  mixture << 1e6, 0.0, 3.0, 0.0, 1e-6, 0.0, 2e5, 1e-7, -1.0;
  MatrixXd moved = trials * mixture;
  moved.rowwise() += Eigen::RowVector3d(1e6, -1e-6, 50.0);
  const Manova sut = two_way_manova(trials, {20, 3, 1});
  const Manova other = two_way_manova(moved, {20, 3, 1});
  EXPECT_TRUE(agrees(other.condition.wilks_lambda, sut.condition.wilks_lambda));
  EXPECT_TRUE(agrees(other.subject.pillai.p, sut.subject.pillai.p));
}

std::string message_of(const MatrixXd& observations, const ManovaLayout& layout) {
  return support::refusal([&] { two_way_manova(observations, layout); });
}

TEST(ManovaTest, TooFewDegreesOfFreedomAreNamed) {
  EXPECT_EQ(
      message_of(golden_trials(2).part(5, 2, 1, 5), {5, 2, 1}),
      "observations of the MANOVA: got 4 degrees of freedom of the error, want at least 5, one for "
      "each metric: more subjects, conditions or replicates");
  EXPECT_EQ(message_of(golden_trials(2).part(6, 2, 1, 5), {6, 2, 1}), "accepted");
}

TEST(ManovaTest, ResidualsThatCannotBeAnErrorAreRefused) {
  MatrixXd additive = golden_trials(0).values;
  // 0.1 s + 0.3 c has no residual but rounding.
  for (Eigen::Index i = 0; i < additive.rows(); ++i) {
    const Eigen::Index subject = i / 3, condition = i % 3;
    additive(i, 1) = 0.1 * static_cast<double>(subject) + 0.3 * static_cast<double>(condition);
  }
  for (const double unit : {1.0, 1e-6}) {
    EXPECT_EQ(
        message_of(additive * unit, {12, 3, 1}),
        "manova.metric[1]: got residuals that are zero within rounding, want residuals that vary");
  }
  MatrixXd constant = golden_trials(0).values;
  constant.col(2).setConstant(0.7);
  EXPECT_NE(message_of(constant, {12, 3, 1}).find("manova.metric[2]"), std::string::npos);
  MatrixXd dependent = golden_trials(0).values;
  dependent.col(2) = 2.0 * dependent.col(0) - 5.0 * dependent.col(1);
  EXPECT_NE(message_of(dependent, {12, 3, 1}).find("linearly dependent"), std::string::npos);
}

TEST(ManovaTest, SizesThatDisagreeAreRefused) {
  const MatrixXd trials = golden_trials(0).values;
  for (const ManovaLayout& layout :
       {ManovaLayout{12, 2, 1}, ManovaLayout{12, 3, 2}, ManovaLayout{36, 1, 1},
        ManovaLayout{1, 36, 1}, ManovaLayout{12, 3, 0}, ManovaLayout{0, 0, 0},
        ManovaLayout{-12, -3, 1}, ManovaLayout{std::numeric_limits<Eigen::Index>::max(), 3, 3}}) {
    EXPECT_NE(message_of(trials, layout), "accepted")
        << layout.subjects << " " << layout.conditions << " " << layout.replicates;
  }
  EXPECT_NE(message_of(MatrixXd(36, 0), {12, 3, 1}), "accepted");
  MatrixXd unsound = trials;
  unsound(4, 1) = std::nan("");
  EXPECT_EQ(message_of(unsound, {12, 3, 1}),
            "observations of the MANOVA(4,1): got nan, want a finite value of at most 1e100");
}

}  // namespace
}  // namespace stillhand::statistics::manova_test
