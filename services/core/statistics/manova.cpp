// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/manova.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Smallest pivot of the residuals, with columns of unit length; R's summary.manova has the same.
constexpr double kDependent = 1e-7;

// Square roots of the cross products of Eq. ST-7: H = effect' effect, E = error' error.
struct Parts {
  MatrixXd condition, subject, interaction, error;
  double error_df;
};

void check(const MatrixXd& observations, const ManovaLayout& layout) {
  const auto at_least = [](const char* name, Index got, Index want) {
    if (got < want) {
      throw ConfigError(std::string("manova.") + name, std::to_string(got),
                        "at least " + std::to_string(want));
    }
  };
  at_least("subjects", layout.subjects, 2);
  at_least("conditions", layout.conditions, 2);
  at_least("replicates", layout.replicates, 1);
  at_least("metrics", observations.cols(), 1);
  // By division: the product of absurd sizes might overflow.
  const Index rows = observations.rows();
  if (rows % layout.subjects != 0 || rows / layout.subjects % layout.conditions != 0 ||
      rows / layout.subjects / layout.conditions != layout.replicates) {
    throw ConfigError("observations of the MANOVA", std::to_string(rows) + " rows",
                      "subjects x conditions x replicates");
  }
  for (Index row = 0; row < rows; ++row) {
    for (Index metric = 0; metric < observations.cols(); ++metric) {
      if (!(std::abs(observations(row, metric)) <= kLargestMagnitude)) {
        throw ConfigError("observations of the MANOVA(" + std::to_string(row) + "," +
                              std::to_string(metric) + ")",
                          std::to_string(observations(row, metric)),
                          "a finite value of at most 1e100");
      }
    }
  }
}

// Centred, and scaled to a largest magnitude of 1; a constant metric stays as zeros.
MatrixXd standardised(const MatrixXd& observations) {
  MatrixXd out = observations.rowwise() - observations.colwise().mean();
  for (Index metric = 0; metric < out.cols(); ++metric) {
    const double largest = out.col(metric).cwiseAbs().maxCoeff();
    if (largest > 0.0) out.col(metric) /= largest;
  }
  return out;
}

// Eq. ST-7, by means of cells, subjects and conditions.
Parts decomposed(const MatrixXd& y, const ManovaLayout& layout) {
  const Index subjects = layout.subjects, conditions = layout.conditions, r = layout.replicates;
  const double s = static_cast<double>(subjects), c = static_cast<double>(conditions);
  const double replicates = static_cast<double>(r);
  MatrixXd cell(subjects * conditions, y.cols());
  MatrixXd subject = MatrixXd::Zero(subjects, y.cols());
  MatrixXd condition = MatrixXd::Zero(conditions, y.cols());
  MatrixXd within(y.rows(), y.cols());
  for (Index i = 0; i < cell.rows(); ++i) {
    const auto observed = y.middleRows(i * r, r);
    cell.row(i) = observed.colwise().mean();
    within.middleRows(i * r, r) = observed.rowwise() - cell.row(i);
    subject.row(i / conditions) += cell.row(i) / c;
    condition.row(i % conditions) += cell.row(i) / s;
  }
  const Eigen::RowVectorXd grand = subject.colwise().mean();
  MatrixXd residual(cell.rows(), y.cols());
  for (Index i = 0; i < cell.rows(); ++i) {
    residual.row(i) = cell.row(i) - subject.row(i / conditions) - condition.row(i % conditions);
    residual.row(i) += grand;
  }
  Parts out;
  out.condition = std::sqrt(s * replicates) * (condition.rowwise() - grand);
  out.subject = std::sqrt(c * replicates) * (subject.rowwise() - grand);
  out.interaction = std::sqrt(replicates) * residual;
  out.error = r == 1 ? residual : within;
  out.error_df = r == 1 ? (s - 1.0) * (c - 1.0) : s * c * (replicates - 1.0);
  return out;
}

// A residual is the difference of a value and up to three means of such values, each within
// epsilon of the metric's largest magnitude.
void check_residuals(const MatrixXd& observations, const MatrixXd& error, double error_df) {
  if (error_df < static_cast<double>(observations.cols())) {
    throw ConfigError("observations of the MANOVA",
                      std::to_string(std::lround(error_df)) + " degrees of freedom of the error",
                      "at least " + std::to_string(observations.cols()) +
                          ", one for each metric: more subjects, conditions or replicates");
  }
  for (Index metric = 0; metric < observations.cols(); ++metric) {
    const auto values = observations.col(metric).array();
    const double spread = (values - values.mean()).abs().maxCoeff();
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * values.abs().maxCoeff();
    // error is in units of the spread.
    const double rms = error.col(metric).norm() / std::sqrt(static_cast<double>(error.rows()));
    if (!(rms * spread > rounding)) {
      throw ConfigError("manova.metric[" + std::to_string(metric) + "]",
                        "residuals that are zero within rounding", "residuals that vary");
    }
  }
}

FTest f_test(double f, double numerator_df, double denominator_df) {
  return {f, numerator_df, denominator_df, f_above(f, numerator_df, denominator_df)};
}

// Eq. ST-8 to ST-10 from the eigenvalues of E^-1 H; p metrics, q and v degrees of freedom.
MultivariateTest test_of(const VectorXd& eigenvalues, double p, double q, double v) {
  MultivariateTest out;
  const double s = std::min(p, q);
  double log_lambda = 0.0, complement_of_trace = 0.0;
  for (Index i = 0; i < static_cast<Index>(s); ++i) {
    log_lambda -= std::log1p(eigenvalues(i));
    out.pillai_trace += eigenvalues(i) / (1.0 + eigenvalues(i));
    complement_of_trace += 1.0 / (1.0 + eigenvalues(i));
  }
  out.wilks_lambda = std::exp(log_lambda);
  const double shape = p * p + q * q - 5.0;
  const double root = shape > 0.0 ? std::sqrt((p * p * q * q - 4.0) / shape) : 1.0;
  const double wilks_df = (v - (p - q + 1.0) / 2.0) * root - p * q / 2.0 + 1.0;
  out.wilks = f_test(std::expm1(-log_lambda / root) * wilks_df / (p * q), p * q, wilks_df);
  const double pillai_1 = s * std::max(p, q);
  const double pillai_2 = s * (v - p + s);
  // s - trace, summed as it is: the difference would cancel for strong effects.
  out.pillai =
      f_test(out.pillai_trace / complement_of_trace * pillai_2 / pillai_1, pillai_1, pillai_2);
  return out;
}

// Eigenvalues of E^-1 H as squared singular values of effect R^-1, error = Q R: the cross products,
// whose condition number is the square of the residuals', are never formed.
class ErrorMetric {
 public:
  explicit ErrorMetric(const MatrixXd& error)
      : scale_(error.colwise().norm()), qr_((error * scale_.cwiseInverse().asDiagonal()).eval()) {
    if (std::abs(qr_.matrixR()(error.cols() - 1, error.cols() - 1)) < kDependent) {
      throw ConfigError("observations of the MANOVA", "metrics with linearly dependent residuals",
                        "metrics of which none is a linear combination of the others");
    }
  }

  VectorXd eigenvalues(const MatrixXd& effect) const {
    const MatrixXd scaled = effect * scale_.cwiseInverse().asDiagonal() * qr_.colsPermutation();
    const Index p = scaled.cols();
    const MatrixXd ratio =
        qr_.matrixR().topLeftCorner(p, p).triangularView<Eigen::Upper>().transpose().solve(
            scaled.transpose());
    return signal::singular_values(ratio).array().square();
  }

 private:
  VectorXd scale_;
  Eigen::ColPivHouseholderQR<MatrixXd> qr_;
};

}  // namespace

Manova two_way_manova(const MatrixXd& observations, const ManovaLayout& layout) {
  check(observations, layout);
  const Parts parts = decomposed(standardised(observations), layout);
  check_residuals(observations, parts.error, parts.error_df);
  const ErrorMetric error(parts.error);
  const double p = static_cast<double>(observations.cols());
  const double subject_df = static_cast<double>(layout.subjects - 1);
  const double condition_df = static_cast<double>(layout.conditions - 1);
  const double v = parts.error_df;
  Manova out;
  out.error_df = v;
  out.condition = test_of(error.eigenvalues(parts.condition), p, condition_df, v);
  out.subject = test_of(error.eigenvalues(parts.subject), p, subject_df, v);
  if (layout.replicates > 1) {
    const double q = subject_df * condition_df;
    out.interaction = test_of(error.eigenvalues(parts.interaction), p, q, v);
  }
  return out;
}

}  // namespace stillhand::statistics
