// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::study {
namespace {

// Of the logarithm of the standard deviation of n normal values, Eq. SU-8.
double log_deviation_bias(double n) {
  return 0.5 * (boost::math::digamma((n - 1.0) / 2.0) - std::log((n - 1.0) / 2.0));
}
double log_deviation_variance(double n) { return 0.25 * boost::math::trigamma((n - 1.0) / 2.0); }

using Differences = Eigen::Matrix<double, kTableMeans, 1>;

// A, B - A, C - B of each metric.
Differences differences(const Metrics& m) {
  Differences out;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    out[row] = m[k];
    out[3 + row] = m[3 + k] - m[k];
    out[6 + row] = m[6 + k] - m[3 + k];
  }
  return out;
}

}  // namespace

Prediction predict_tables(const std::vector<Metrics>& subjects, std::size_t simulated) {
  std::vector<Differences> rows;
  for (const Metrics& metrics : subjects) {
    const Differences row = differences(metrics);
    if (row.allFinite()) rows.push_back(row);
  }
  if (rows.size() < 3 || simulated < 2) {
    throw ConfigError("--explain-paper", std::to_string(rows.size()) + " subjects with a crossover",
                      "three or more");
  }
  const auto n = static_cast<double>(rows.size());
  Differences mean = Differences::Zero();
  for (const Differences& row : rows) mean += row / n;
  Eigen::Matrix<double, kTableMeans, kTableMeans> covariance;
  covariance.setZero();
  for (const Differences& row : rows) covariance += (row - mean) * (row - mean).transpose() / n;
  covariance *= 1.0 + 1.0 / static_cast<double>(simulated - 1);

  Prediction out;
  const auto fill = [&](TableMatrix& matrix, double count) {
    matrix.setZero();
    matrix.topLeftCorner<kTableMeans, kTableMeans>() = covariance / count;
    for (Eigen::Index i = 3; i < kTableMeans; ++i) {
      for (Eigen::Index j = 3; j < kTableMeans; ++j) {
        const double squared =
            covariance(i, j) * covariance(i, j) / (covariance(i, i) * covariance(j, j));
        matrix(6 + i, 6 + j) = squared * log_deviation_variance(count);
      }
    }
  };
  fill(out.sampling, kPaperSubjects);
  fill(out.simulation, static_cast<double>(simulated));
  out.mean.head<kTableMeans>() = mean;
  for (Eigen::Index i = 3; i < kTableMeans; ++i) {
    out.mean[6 + i] = 0.5 * std::log(covariance(i, i)) + log_deviation_bias(kPaperSubjects);
  }
  return out;
}

Fit fit_tables(const Prediction& prediction, const PaperTables& paper, const Nuisance& nuisance) {
  const Eigen::MatrixXd spread = nuisance.slope * nuisance.prior_sd.asDiagonal();
  const TableVector unit = kLogUnitDeviation * paper.per_log_unit;
  const TableMatrix all = prediction.sampling + prediction.simulation + paper.uncertainty +
                          TableMatrix(spread * spread.transpose() + unit * unit.transpose());
  const TableVector off = paper.values - prediction.mean;
  const Eigen::LLT<TableMatrix> factor(all);
  const TableVector weighted = factor.solve(off);
  const TableMatrix lower = factor.matrixL();
  Fit out;
  out.chi_square = off.dot(weighted);
  out.log_likelihood = -0.5 * out.chi_square - lower.diagonal().array().log().sum() -
                       0.5 * static_cast<double>(kTableFigures) * std::log(2.0 * std::numbers::pi);
  out.shift = nuisance.prior_sd.asDiagonal() * (spread.transpose() * weighted);
  out.after = prediction.mean + nuisance.slope * out.shift;
  return out;
}

}  // namespace stillhand::study
