// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/lagged_products.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/feedthrough_records.hpp"

namespace stillhand::identification::lagged_products_test {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix columns_of(const std::vector<double>& x, Eigen::Index lags, Eigen::Index first,
                  Eigen::Index end) {
  Matrix out(end - first, lags + 1);
  for (Eigen::Index n = first; n < end; ++n) {
    for (Eigen::Index lag = 0; lag <= lags; ++lag) {
      out(n - first, lag) = x[static_cast<std::size_t>(n - lag)];
    }
  }
  return out;
}

TEST(LaggedProductsTest, CopiesEndWithTheSignalItself) {
  const std::vector<double> x{0.0, 1.0, 2.0, 3.0, 4.0};
  const LaggedCopies sut = lagged_copies(x, 2, 3, 5);
  const Matrix expected{{1.0, 2.0, 3.0}, {2.0, 3.0, 4.0}};
  EXPECT_EQ(Matrix(sut), expected);
}

TEST(LaggedProductsTest, GramIsTheProductOfTheColumns) {
  constexpr Eigen::Index kLags = 6;
  const auto a = support::white_noise(700, 2.0, 1);
  const auto f = support::band_noise(700, 50.0, 0.7, 4.0, 5.0, 2);
  Matrix columns(600, 2 * (kLags + 1));
  columns << columns_of(a, kLags, 40, 640), columns_of(f, kLags, 40, 640);
  const Matrix expected = columns.transpose() * columns;
  const Matrix sut = lagged_gram({&a, &f}, kLags, 40, 640);
  // 600 products summed in another order, and kLags more sums: at most so many roundings each.
  const double bound = 2.0 * (600.0 + kLags) * std::numeric_limits<double>::epsilon();
  for (Eigen::Index i = 0; i < sut.rows(); ++i) {
    for (Eigen::Index j = 0; j < sut.cols(); ++j) {
      const double size = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(sut(i, j), expected(i, j), bound * size) << i << ", " << j;
    }
  }
}

TEST(LaggedProductsTest, AdjacentRowsAddUp) {
  const auto x = support::white_noise(300, 1.0, 3);
  const Matrix sut = lagged_gram({&x}, 4, 4, 200) + lagged_gram({&x}, 4, 200, 300);
  const Matrix whole = lagged_gram({&x}, 4, 4, 300);
  const double bound = 600.0 * std::numeric_limits<double>::epsilon() * whole(0, 0);
  EXPECT_LT((sut - whole).cwiseAbs().maxCoeff(), bound);
}

}  // namespace
}  // namespace stillhand::identification::lagged_products_test
