// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/arx.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/identification/excitation_check.hpp"
#include "services/core/identification/lagged_products.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::identification {
namespace {

// Cholesky's factor of A^T A carries an error of eps kappa^2, by which each correction falls short:
// 2e-6 at this condition, so that two corrections leave 1e-17.
constexpr double kMostCondition = 1e5;
constexpr int kMostCorrections = 4;
// What is left after a correction is about its square.
constexpr double kLastCorrection = 1e-8;

struct LeastSquares {
  DifferenceModel model;
  double condition_number;
};

DifferenceModel model_of(const Eigen::VectorXd& parameters, Eigen::Index order, double rate_hz) {
  DifferenceModel model;
  model.rate_hz = rate_hz;
  model.numerator.assign(parameters.begin(), parameters.begin() + order + 1);
  model.denominator.assign(1, 1.0);
  model.denominator.insert(model.denominator.end(), parameters.begin() + order + 1,
                           parameters.end());
  return model;
}

// A of Eq. ID-2 (paper Eq. 4): columns a(n) .. a(n-p), -f(n-1) .. -f(n-p).
Eigen::MatrixXd data_matrix(const Record& record, Eigen::Index order, Eigen::Index end) {
  const Eigen::Index rows = end - order;
  Eigen::MatrixXd matrix(rows, 2 * order + 1);
  for (Eigen::Index i = 0; i <= order; ++i) {
    matrix.col(i) =
        Eigen::Map<const Eigen::VectorXd>(record.acceleration_m_s2.data() + order - i, rows);
  }
  for (Eigen::Index j = 1; j <= order; ++j) {
    matrix.col(order + j) =
        -Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order - j, rows);
  }
  return matrix;
}

LeastSquares solve(Eigen::MatrixXd matrix, const Eigen::VectorXd& b, Eigen::Index order,
                   double rate_hz) {
  // Columns of norm 1: acceleration and force have different units.
  const Eigen::RowVectorXd norms = matrix.colwise().norm();
  matrix.array().rowwise() /= norms.array();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::VectorXd parameters = (qr.solve(b).array() / norms.transpose().array()).matrix();
  const Eigen::MatrixXd r =
      qr.matrixR().topRows(matrix.cols()).triangularView<Eigen::Upper>().toDenseMatrix();
  const Eigen::VectorXd singular = signal::singular_values(r);
  return {model_of(parameters, order, rate_hz), singular(0) / singular(singular.size() - 1)};
}

// A^T (f - A x) of the rows order .. end - 1, without A.
Eigen::VectorXd gradient(const Record& record, const Eigen::VectorXd& x, Eigen::Index order,
                         Eigen::Index end) {
  const LaggedCopies a = lagged_copies(record.acceleration_m_s2, order, order, end);
  const LaggedCopies f = lagged_copies(record.force_n, order, order, end);
  // Columns of the copies go from the largest lag to 0.
  Eigen::VectorXd residual = f.col(order);
  residual.noalias() -= a * x.head(order + 1).reverse().eval();
  residual.noalias() += f.leftCols(order) * x.tail(order).reverse().eval();
  Eigen::VectorXd out(2 * order + 1);
  out.head(order + 1) = (a.transpose() * residual).reverse();
  out.tail(order) = -(f.leftCols(order).transpose() * residual).reverse();
  return out;
}

// Corrected seminormal equations, Eq. ID-19.  Nothing where the factor is too poor for them.
// @param gram  lagged_gram() of acceleration and force over the rows order .. end - 1
std::optional<LeastSquares> solve_by_products(const Record& record, const Eigen::MatrixXd& gram,
                                              Eigen::Index order, Eigen::Index end) {
  const Eigen::Index count = 2 * order + 1;
  Eigen::MatrixXd normal(count, count);  // without the column f(n), signs as in A
  normal.topLeftCorner(order + 1, order + 1) = gram.topLeftCorner(order + 1, order + 1);
  normal.bottomRightCorner(order, order) = gram.bottomRightCorner(order, order);
  normal.topRightCorner(order + 1, order) = -gram.topRightCorner(order + 1, order);
  normal.bottomLeftCorner(order, order + 1) = -gram.bottomLeftCorner(order, order + 1);
  Eigen::VectorXd right(count);
  right << gram.col(order + 1).head(order + 1), -gram.col(order + 1).tail(order);

  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  normal = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::VectorXd eigenvalues = signal::symmetric_eigenvalues(normal);
  const double condition = std::sqrt(eigenvalues(count - 1) / eigenvalues(0));
  if (!(eigenvalues(0) > 0.0) || !(condition < kMostCondition)) return std::nullopt;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(normal);
  Eigen::VectorXd x = cholesky.solve(scale.cwiseProduct(right));
  for (int k = 0; k < kMostCorrections; ++k) {
    const Eigen::VectorXd correction =
        cholesky.solve(scale.cwiseProduct(gradient(record, scale.cwiseProduct(x), order, end)));
    x += correction;
    if (correction.norm() <= kLastCorrection * x.norm()) {
      return LeastSquares{model_of(scale.cwiseProduct(x), order, record.rate_hz), condition};
    }
  }
  return std::nullopt;
}

// On the rows order .. end - 1.
LeastSquares solve(const Record& record, const Eigen::MatrixXd& gram, Eigen::Index order,
                   Eigen::Index end) {
  if (auto solved = solve_by_products(record, gram, order, end)) return *solved;
  const Eigen::VectorXd force =
      Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order, end - order);
  return solve(data_matrix(record, order, end), force, order, record.rate_hz);
}

void check_order(int order) {
  if (order < kMinOrder || order > kMaxOrder) {
    throw ConfigError("identification.order", std::to_string(order),
                      std::to_string(kMinOrder) + " to " + std::to_string(kMaxOrder));
  }
}

// Sound, and an equation more than parameters.
void check_determined(const Record& record, int order) {
  check(record);
  check_order(order);
  const auto least = 3 * static_cast<std::size_t>(order) + 2;
  if (record.size() < least) {
    throw ConfigError("recording", std::to_string(record.size()) + " samples",
                      std::to_string(least) + " or more");
  }
}

std::vector<const std::vector<double>*> signals_of(const Record& record) {
  return {&record.acceleration_m_s2, &record.force_n};
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

ArxFactor factor_arx(const Record& record, int order) {
  check_determined(record, order);
  const Eigen::Index columns = 2 * order + 2;
  const auto end = static_cast<Eigen::Index>(record.size());
  Eigen::MatrixXd with_force(end - order, columns);
  with_force.leftCols(columns - 1) = data_matrix(record, order, end);
  with_force.col(columns - 1) =
      Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order, with_force.rows());
  const RowMajor triangle = signal::upper_factor(with_force).topRows(columns - 1);
  return {order, record.rate_hz,
          std::vector<double>(triangle.data(), triangle.data() + triangle.size())};
}

DifferenceModel fit_pooled(const std::vector<ArxFactor>& factors) {
  if (factors.empty()) throw ConfigError("identification.records", "none", "one or more");
  const ArxFactor& first = factors.front();
  const Eigen::Index columns = 2 * first.order + 2;
  RowMajor stacked((columns - 1) * static_cast<Eigen::Index>(factors.size()), columns);
  Eigen::Index row = 0;
  for (const ArxFactor& factor : factors) {
    if (factor.order != first.order || factor.rate_hz != first.rate_hz) {
      throw ConfigError("identification.records", "different orders or rates", "the same");
    }
    stacked.middleRows(row, columns - 1) =
        Eigen::Map<const RowMajor>(factor.triangle.data(), columns - 1, columns);
    row += columns - 1;
  }
  return solve(stacked.leftCols(columns - 1), stacked.col(columns - 1), first.order, first.rate_hz)
      .model;
}

DifferenceModel least_squares(const Record& record, int order) {
  check_determined(record, order);
  const auto end = static_cast<Eigen::Index>(record.size());
  return solve(record, lagged_gram(signals_of(record), order, order, end), order, end).model;
}

ArxFit fit_arx(const Record& record, int order) {
  check_order(order);
  require_excitation(record, order);
  const auto end = static_cast<Eigen::Index>(record.size());
  const Eigen::Index split = end - end / 4;
  const std::vector<const std::vector<double>*> signals{&record.acceleration_m_s2, &record.force_n};
  Eigen::MatrixXd gram = lagged_gram(signals, order, order, split);
  const LeastSquares seen = solve(record, gram, order, split);
  gram += lagged_gram(signals, order, split, end);
  const LeastSquares all = solve(record, gram, order, end);
  ArxFit fit;
  fit.model = all.model;
  fit.condition_number = all.condition_number;
  fit.stable = signal::is_stable(all.model) && signal::is_stable(seen.model);
  fit.heldout = quality(seen.model, record, static_cast<std::size_t>(split));
  return fit;
}

}  // namespace stillhand::identification
