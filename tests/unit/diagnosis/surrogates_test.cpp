// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/surrogates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::surrogates_test {

using made::column_of;

constexpr std::size_t kCount = 6000;
constexpr std::size_t kFew = 8;

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.dot(b) / (a.norm() * b.norm());
}

// [-] from each sample to the next: the colour.
double of_neighbours(const Eigen::VectorXd& x) {
  return correlation(x.head(x.size() - 1), x.tail(x.size() - 1));
}

TEST(SurrogatesTest, EachHasThePowerAndTheColourAndIsAnotherNoise) {
  const Eigen::VectorXd residual =
      column_of(made::answer({1.0}, {1.0, -0.8}, made::white(kCount, 1)));
  const Eigen::MatrixXd sut = surrogates(residual, std::vector<double>(kCount, 1.0), kFew);
  ASSERT_EQ(sut.cols(), static_cast<Eigen::Index>(kFew));
  for (Eigen::Index i = 0; i < sut.cols(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_NEAR(sut.col(i).norm(), residual.norm(), 1e-6 * residual.norm());
    EXPECT_NEAR(of_neighbours(sut.col(i)), 0.8, 0.03);
    // The standard deviation of a correlation of such noises is sqrt(4.6/6000) = 0.028.
    EXPECT_LT(std::abs(correlation(sut.col(i), residual)), 0.11);
    for (Eigen::Index j = 0; j < i; ++j) {
      EXPECT_LT(std::abs(correlation(sut.col(i), sut.col(j))), 0.11) << j;
    }
  }
}

// A burst stays one in those that are moved, every second one; other phases spread it.
TEST(SurrogatesTest, WhatIsMovedInTimeKeepsItsBursts) {
  std::vector<double> burst = made::white(kCount, 2);
  for (std::size_t n = 0; n < 50; ++n) burst[n + 1000] *= 30.0;
  const Eigen::VectorXd residual = column_of(burst);
  const Eigen::MatrixXd sut = surrogates(residual, std::vector<double>(kCount, 1.0), kFew);
  for (Eigen::Index i = 0; i < sut.cols(); ++i) {
    const double largest = sut.col(i).cwiseAbs().maxCoeff();
    if (i % 2 == 0) {
      // Backwards, and moved by a tenth to nine tenths: 0.15, 0.35 .. of it.
      const auto moved = static_cast<Eigen::Index>(900 + 600 * i);
      EXPECT_EQ(sut(0, i), residual[kCount - 1 - moved]) << i;
      EXPECT_EQ(largest, residual.cwiseAbs().maxCoeff()) << i;
    } else {
      EXPECT_LT(largest, 0.5 * residual.cwiseAbs().maxCoeff()) << i;
    }
  }
}

TEST(SurrogatesTest, TheCircleHasTheSamplesThatWeigh) {
  const Eigen::Vector<double, 5> residual{1.0, 0.0, 2.0, 3.0, 4.0};
  const std::vector<double> weight{1.0, 0.0, 1.0, 1.0, 1.0};
  EXPECT_EQ(moved_in_time(residual, weight, 0.25, false),
            (Eigen::Vector<double, 5>{2.0, 0.0, 3.0, 4.0, 1.0}));
  EXPECT_EQ(moved_in_time(residual, weight, 0.25, true),
            (Eigen::Vector<double, 5>{3.0, 0.0, 2.0, 1.0, 4.0}));
}

TEST(SurrogatesTest, SamplesThatWeighNothingStayZero) {
  std::vector<double> weight(kCount, 1.0);
  std::fill_n(weight.begin() + 100, 500, 0.0);
  Eigen::VectorXd residual = column_of(made::white(kCount, 3));
  residual.segment(100, 500).setZero();
  const Eigen::MatrixXd sut = surrogates(residual, weight, kFew);
  EXPECT_EQ(sut.middleRows(100, 500).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_NEAR(sut.col(1).norm(), residual.norm(), 1e-6 * residual.norm());
}

TEST(SurrogatesTest, ProbabilityCountsTheRecordItself) {
  const Eigen::ArrayXd of_surrogates = Eigen::ArrayXd::LinSpaced(99, 0.0, 0.98);
  EXPECT_DOUBLE_EQ(surrogate_p(1.0, of_surrogates), 0.01);
  EXPECT_DOUBLE_EQ(surrogate_p(0.485, of_surrogates), 0.51);
  EXPECT_DOUBLE_EQ(surrogate_p(0.0, of_surrogates), 1.0);
}

SurrogateShares shares_of(const made::Studied& of, const Columns& columns) {
  const Screening& screening = of.screening;
  return SurrogateGains(screening.jacobian(), screening.residual(), screening.weight(), of.blocks)
      .shares(screening.as_added(columns));
}

TEST(SurrogatesTest, EachHasTheShareOfAResidualThatIsIt) {
  const made::Studied of(made::with_another_channel(kCount), 2);
  const Columns columns{of.signals.at("v").values, made::white(kCount, 7)};
  const SurrogateShares sut = shares_of(of, columns);
  EXPECT_NEAR(sut.own, of.screening.gain(columns).share, 1e-9);
  const Eigen::MatrixXd all = surrogates(of.screening.residual(), of.screening.weight(),
                                         static_cast<std::size_t>(kSurrogates));
  for (Eigen::Index i = 0; i < kSurrogates; ++i) {
    Measurement made_of_it = made::with_another_channel(kCount);
    std::vector<double>& output = made_of_it.channels[2].values;
    output = of.screening.prediction();
    for (std::size_t n = 0; n < output.size(); ++n) {
      output[n] += all(static_cast<Eigen::Index>(n), i);
    }
    const Signals with_it(made_of_it, {"u"}, "y");
    const Screening screening(of.baseline.model, with_it, of.blocks, of.impulse_response);
    // The initial state has been taken out of the residual there, of some ten samples.
    EXPECT_NEAR(sut.surrogates[i], screening.gain(columns).share, 1e-3) << i;
  }
}

}  // namespace stillhand::diagnosis::surrogates_test
