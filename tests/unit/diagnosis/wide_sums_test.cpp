// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/record/wide_sums.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stillhand::diagnosis::wide_sums_test {

constexpr Eigen::Index kRows = 43;  // no multiple of what is summed at once
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

Eigen::MatrixXd some_columns(Eigen::Index count) {
  Eigen::MatrixXd columns(kRows, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    for (Eigen::Index n = 0; n < kRows; ++n) {
      columns(n, c) = std::sin(0.3 * static_cast<double>((n + 1) * (c + 2)));
    }
  }
  return columns;
}

// Oracle: sums in double, one after the other.  Each of both sums is off by at most rows x epsilon
// of the sum of sizes, here at most rows.
TEST(WideSumsTest, ProductsAreThoseOfEveryPairOfColumns) {
  for (const Eigen::Index count : {1, 2, 5, 8}) {
    const Eigen::MatrixXd columns = some_columns(count);
    ColumnPointers pointers;
    append_columns(columns, 0, pointers);
    Eigen::MatrixXd sut(count, count);
    write_products(pointers, kRows, 0, sut);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j) {
        double want = 0.0;
        for (Eigen::Index n = 0; n < kRows; ++n) want += columns(n, i) * columns(n, j);
        EXPECT_NEAR(sut(i, j), want, 2.0 * kRows * kRows * kEpsilon) << i << ", " << j;
      }
    }
  }
}

TEST(WideSumsTest, ProductsOfEarlierColumnsStay) {
  const Eigen::MatrixXd columns = some_columns(5);
  ColumnPointers pointers;
  append_columns(columns, 3, pointers);
  Eigen::MatrixXd all(5, 5);
  write_products(pointers, kRows - 3, 0, all);
  constexpr double kMark = 77.0;
  Eigen::MatrixXd sut = Eigen::MatrixXd::Constant(5, 5, kMark);
  write_products(pointers, kRows - 3, 2, sut);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 5; ++j) {
      EXPECT_EQ(sut(i, j), i < 2 && j < 2 ? kMark : all(i, j)) << i << ", " << j;
    }
  }
}

// Oracle: the sum as it is written, term by term in the same order: equal to the last bit.
TEST(WideSumsTest, AFilterInPlaceSumsTheSamplesBefore) {
  for (const std::size_t order : {0, 3, 24}) {
    std::vector<double> taps;
    for (std::size_t k = 0; k <= order; ++k) taps.push_back(std::cos(static_cast<double>(k)));
    std::vector<double> x;
    for (std::size_t n = 0; n < 75; ++n) x.push_back(std::sin(0.7 * static_cast<double>(n)));
    std::vector<double> sut = x;
    filter_in_place(taps, sut);
    for (std::size_t n = 0; n < x.size(); ++n) {
      double want = 0.0;
      for (std::size_t k = 0; k <= std::min(order, n); ++k) want += taps[k] * x[n - k];
      EXPECT_EQ(sut[n], want) << "order " << order << ", sample " << n;
    }
  }
}

}  // namespace stillhand::diagnosis::wide_sums_test
