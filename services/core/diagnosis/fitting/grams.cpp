// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/grams.hpp"

#include <algorithm>

#include "services/core/diagnosis/record/wide_sums.hpp"

namespace stillhand::diagnosis {

Eigen::MatrixXd Grams::total(const Blocks& layout, int without_fold) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks.front().rows(), blocks.front().cols());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (static_cast<int>(layout.fold_of(b)) != without_fold) sum += blocks[b];
  }
  return sum;
}

Grams grams_of(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
               const std::vector<double>& weight, const Blocks& blocks) {
  const Eigen::Index columns = jacobian.cols();
  Grams grams;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const auto [first, rows] = rows_of(blocks, b, residual.size());
    ColumnPointers pointers;
    append_columns(jacobian, first, pointers);
    pointers.push_back(residual.data() + first);
    Eigen::MatrixXd gram(columns + 1, columns + 1);
    write_products(pointers, static_cast<std::size_t>(rows), 0, gram);
    grams.blocks.push_back(std::move(gram));
    double sum = 0.0;
    for (Eigen::Index n = first; n < first + rows; ++n) sum += weight[static_cast<std::size_t>(n)];
    grams.weights.push_back(sum);
  }
  return grams;
}

}  // namespace stillhand::diagnosis
