// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Dense decompositions of Eigen behind plain functions: each is instantiated once, where each file
/// that names one takes 3 to 8 s more to compile.  Pure.
/// Source: G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed., the section named.
namespace stillhand::signal {

/// x [n] that minimises |A x - b|, A [m x n], m >= n: QR with column pivoting (5.4.2).
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// x [n] of A x = b, A [n x n] symmetric: pivoted L D L^T (4.4).
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// The same for each column of B.
Eigen::MatrixXd solve_symmetric_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// R [min(m, n) x n] of A = Q R, A [m x n]: Householder, no pivoting (5.2.2).
Eigen::MatrixXd upper_factor(const Eigen::MatrixXd& a);

/// Largest first: one-sided Jacobi (8.6.3).
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

/// A = U diag(values) V' [m x n], min(m, n) values, largest first.
struct SingularValues {
  Eigen::MatrixXd u;
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
/// Two-sided Jacobi of Eigen (8.6.3), with the vectors.
SingularValues singular_vectors(const Eigen::MatrixXd& a);

/// Smallest first, of a symmetric matrix (8.3).
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

/// A = vectors diag(values) vectors' [n x n], symmetric; smallest first.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigenvectors(const Eigen::MatrixXd& a);

/// Of any real square matrix, in no order: Hessenberg form and QR steps (7.5).  NaN where the steps
/// do not converge.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);

}  // namespace stillhand::signal
