// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

namespace stillhand::diagnosis {

/// The two sums in which fits spend most of their time, in the widest registers that the processor
/// has (AVX-512, AVX, otherwise those of the build).  Each adds in one order, whatever the width:
/// the results are the same, bit for bit.  Pure.

/// Columns side by side, as pointers to their first rows.
using ColumnPointers = std::vector<const double*>;

/// Pointers to row `first` of a matrix' columns.
void append_columns(const Eigen::MatrixXd& columns, Eigen::Index first, ColumnPointers& pointers);

/// products(i, j) = products(j, i) = sum over the rows of column_i column_j, for i >= from and all
/// j; the others stay.
/// @param products  [columns x columns]
void write_products(const ColumnPointers& columns, std::size_t rows, Eigen::Index from,
                    Eigen::MatrixXd& products);

/// x(n) <- sum_k taps_k x(n - k), from rest.
void filter_in_place(std::span<const double> taps, std::span<double> x);

}  // namespace stillhand::diagnosis
