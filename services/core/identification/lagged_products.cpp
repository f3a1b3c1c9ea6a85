// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/lagged_products.hpp"

#include "services/core/contract/expects.hpp"

namespace stillhand::identification {
namespace {

// The block of two signals: rows are lags of `left`, columns lags of `right`; row 0 and column 0
// are given.
void continue_block(Eigen::Ref<Eigen::MatrixXd> block, const double* left, const double* right,
                    Eigen::Index first, Eigen::Index end) {
  for (Eigen::Index j = 1; j < block.cols(); ++j) {
    for (Eigen::Index i = 1; i < block.rows(); ++i) {
      block(i, j) = block(i - 1, j - 1) +
                    (left[first - i] * right[first - j] - left[end - i] * right[end - j]);
    }
  }
}

}  // namespace

LaggedCopies lagged_copies(const std::vector<double>& x, Eigen::Index lags, Eigen::Index first,
                           Eigen::Index end) {
  STILLHAND_EXPECTS(lags >= 0 && lags <= first && first <= end &&
                    end <= static_cast<Eigen::Index>(x.size()));
  return {x.data() + first - lags, end - first, lags + 1, Eigen::OuterStride<>(1)};
}

Eigen::MatrixXd lagged_gram(const std::vector<const std::vector<double>*>& signals,
                            Eigen::Index lags, Eigen::Index first, Eigen::Index end) {
  const auto count = static_cast<Eigen::Index>(signals.size());
  const Eigen::Index size = lags + 1;
  Eigen::MatrixXd gram(count * size, count * size);
  for (Eigen::Index s = 0; s < count; ++s) {
    const LaggedCopies copies =
        lagged_copies(*signals[static_cast<std::size_t>(s)], lags, first, end);
    for (Eigen::Index t = 0; t < count; ++t) {
      const auto& other = *signals[static_cast<std::size_t>(t)];
      const Eigen::Map<const Eigen::VectorXd> rows(other.data() + first, end - first);
      const Eigen::VectorXd sums = (copies.transpose() * rows).reverse();
      gram.col(t * size).segment(s * size, size) = sums;
      gram.row(t * size).segment(s * size, size) = sums;
    }
  }
  for (Eigen::Index s = 0; s < count; ++s) {
    for (Eigen::Index t = 0; t < count; ++t) {
      continue_block(gram.block(s * size, t * size, size, size),
                     signals[static_cast<std::size_t>(s)]->data(),
                     signals[static_cast<std::size_t>(t)]->data(), first, end);
    }
  }
  return gram;
}

}  // namespace stillhand::identification
