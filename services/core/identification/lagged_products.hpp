// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace stillhand::identification {

/// Lagged copies of a signal, without a copy: row n - first, column k is x(n - lags + k), for the
/// rows n = first .. end - 1 and k = 0 .. lags; the last column is the signal itself.
/// Needs lags <= first <= end <= x.size(); x must outlive it.
using LaggedCopies = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
LaggedCopies lagged_copies(const std::vector<double>& x, Eigen::Index lags, Eigen::Index first,
                           Eigen::Index end);

/// X^T X over the rows n = first .. end - 1, METHOD Eq. ID-19; X holds, of one signal after the
/// other, x(n), x(n-1) .. x(n-lags).  In the next row a copy holds the value that the copy of one
/// lag less holds in this row, so only the products with lag 0 are summed over the rows.  Gram
/// matrices of adjacent rows add up.  Source of Eq. ID-19: Björck, Linear Algebra Appl. 88/89,
/// 1987. Pure.
Eigen::MatrixXd lagged_gram(const std::vector<const std::vector<double>*>& signals,
                            Eigen::Index lags, Eigen::Index first, Eigen::Index end);

}  // namespace stillhand::identification
