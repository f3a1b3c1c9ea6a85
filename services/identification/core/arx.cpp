// SPDX-License-Identifier: Apache-2.0
#include "identification/core/arx.hpp"

#include <Eigen/Dense>
#include <string>

#include "contract/config_error.hpp"
#include "identification/core/excitation_check.hpp"

namespace stillhand::identification {
namespace {

struct LeastSquares {
  DifferenceModel model;
  double condition_number;
};

// A of Eq. ID-2 (paper Eq. 4): columns a(n) .. a(n-p), -f(n-1) .. -f(n-p).
Eigen::MatrixXd data_matrix(const Record& record, Eigen::Index order) {
  const auto rows = static_cast<Eigen::Index>(record.size()) - order;
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
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(r).singularValues();
  LeastSquares out;
  out.condition_number = singular(0) / singular(singular.size() - 1);
  out.model.rate_hz = rate_hz;
  out.model.numerator.assign(parameters.begin(), parameters.begin() + order + 1);
  out.model.denominator.assign(1, 1.0);
  out.model.denominator.insert(out.model.denominator.end(), parameters.begin() + order + 1,
                               parameters.end());
  return out;
}

LeastSquares solve(const Record& record, int order) {
  Eigen::MatrixXd matrix = data_matrix(record, order);
  const Eigen::VectorXd force =
      Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order, matrix.rows());
  return solve(std::move(matrix), force, order, record.rate_hz);
}

void check_order(int order) {
  if (order < kMinOrder || order > kMaxOrder) {
    throw ConfigError("identification.order", std::to_string(order),
                      std::to_string(kMinOrder) + " to " + std::to_string(kMaxOrder));
  }
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

ArxFactor factor_arx(const Record& record, int order) {
  check(record);
  check_order(order);
  const Eigen::Index columns = 2 * order + 2;
  if (static_cast<Eigen::Index>(record.size()) < columns + order) {
    throw ConfigError("identification.record", std::to_string(record.size()) + " samples",
                      std::to_string(columns + order) + " or more");
  }
  Eigen::MatrixXd with_force(static_cast<Eigen::Index>(record.size()) - order, columns);
  with_force.leftCols(columns - 1) = data_matrix(record, order);
  with_force.col(columns - 1) =
      Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order, with_force.rows());
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(with_force);
  const RowMajor triangle =
      qr.matrixQR().topRows(columns - 1).triangularView<Eigen::Upper>().toDenseMatrix();
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

ArxFit fit_arx(const Record& record, int order) {
  check_order(order);
  const Excitation excitation = check_excitation(record, order);
  if (!excitation.sufficient) {
    throw ConfigError("identification.record", excitation.verdict,
                      "a record that excites the body");
  }
  const LeastSquares all = solve(record, order);
  const std::size_t split = record.size() - record.size() / 4;
  const LeastSquares seen = solve(part(record, 0, split), order);
  ArxFit fit;
  fit.model = all.model;
  fit.condition_number = all.condition_number;
  fit.stable = signal::is_stable(all.model) && signal::is_stable(seen.model);
  fit.heldout = quality(seen.model, record, split);
  return fit;
}

}  // namespace stillhand::identification
