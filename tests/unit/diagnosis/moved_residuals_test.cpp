// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/moved_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/diagnosis/made_measurement.hpp"

namespace stillhand::diagnosis::moved_residuals_test {

constexpr std::size_t kCount = 6000;
constexpr double kNoise = 0.1;
constexpr std::size_t kMoved = 4;

// y = 2 u + noise, a static model, and columns next to it: the input, a noise, and their sum.
struct Moved {
  Moved() : sut(of.baseline.model, of.signals, of.blocks, columns(), kMoved) {}

  [[nodiscard]] static Measurement measurement() {
    const auto u = made::ride(kCount, 1);
    const auto y = made::mix({{2.0, u}, {kNoise, made::white(kCount, 2)}});
    return made::measurement_of({{"u", "V", u}, {"y", "N", y}});
  }
  [[nodiscard]] static Eigen::MatrixXd columns() {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(kCount), 3);
    all.col(0) = made::column_of(made::ride(kCount, 1));
    all.col(1) = made::column_of(made::white(kCount, 3));
    all.col(2) = all.col(0) + all.col(1);
    return all;
  }

  made::Studied of{measurement(), 0};
  MovedResiduals sut;
};

// Both have an RMS of 1 and nothing in common.
TEST(MovedResidualsTest, WhatTheModelCannotImitateIsWhatIsLeftNextToItsColumns) {
  const Moved moved;
  EXPECT_LT(moved.sut.beyond(0), 0.01);
  EXPECT_GT(moved.sut.beyond(1), 0.99);
  EXPECT_NEAR(moved.sut.beyond(2), std::sqrt(0.5), 0.02);
}

TEST(MovedResidualsTest, AColumnThatWasAddedIsFoundNextToTheModel) {
  const Moved moved;
  for (std::size_t i = 0; i < kMoved; ++i) {
    EXPECT_NEAR(moved.sut.without(1, 0.0, i).rmse(), kNoise, 0.03 * kNoise) << i;
    EXPECT_NEAR(moved.sut.without(1, 0.5, i).rmse(), std::hypot(kNoise, 0.5), 0.01) << i;
    EXPECT_NEAR(moved.sut.with(1, 0.5, i).rmse(), kNoise, 0.03 * kNoise) << i;
    // The model has the input already.
    EXPECT_NEAR(moved.sut.without(0, 0.5, i).rmse(), kNoise, 0.03 * kNoise) << i;
  }
}

}  // namespace stillhand::diagnosis::moved_residuals_test
