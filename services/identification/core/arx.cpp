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

LeastSquares solve(const Record& record, int order_asked) {
  const Eigen::Index order = order_asked;
  Eigen::MatrixXd matrix = data_matrix(record, order);
  const Eigen::VectorXd b =
      Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + order, matrix.rows());
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
  out.model.rate_hz = record.rate_hz;
  out.model.numerator.assign(parameters.begin(), parameters.begin() + order + 1);
  out.model.denominator.assign(1, 1.0);
  out.model.denominator.insert(out.model.denominator.end(), parameters.begin() + order + 1,
                               parameters.end());
  return out;
}

}  // namespace

ArxFit fit_arx(const Record& record, int order) {
  if (order < kMinOrder || order > kMaxOrder) {
    throw ConfigError("identification.order", std::to_string(order),
                      std::to_string(kMinOrder) + " to " + std::to_string(kMaxOrder));
  }
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
