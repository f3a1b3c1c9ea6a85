// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/study/explain/paper_tables.hpp"
#include "apps/study/explain/responses.hpp"

namespace stillhand::study {

/// What a population would print in the paper's tables.
struct Prediction {
  TableVector mean;
  TableMatrix sampling;  ///< covariance of the tables of twelve subjects
  TableMatrix
      simulation;  ///< covariance of `mean` itself: the simulated subjects are finitely many
};

/// METHOD Eq. SU-8.  Means are normal with the covariance of the subjects over 12; the logarithm of
/// a standard deviation is normal with the bias and variance of 11 degrees of freedom, and two of
/// them correlate with the square of the metrics' correlation.  Subjects without a crossover are
/// left out.
/// @param subjects   metrics of each, real or drawn
/// @param simulated  number of independent subjects behind them
/// @throws ConfigError with fewer than three subjects left
Prediction predict_tables(const std::vector<Metrics>& subjects, std::size_t simulated);

/// The calibrated means (causes.hpp) as nuisance parameters, linear about the default population,
/// Eq. SU-9.
struct Nuisance {
  Eigen::MatrixXd slope;     ///< [table figure x parameter] per unit of the logarithm
  Eigen::VectorXd prior_sd;  ///< of the logarithm
};

/// How well a prediction meets the paper's tables, the nuisance parameters integrated out.
struct Fit {
  double log_likelihood = 0.0;
  double chi_square = 0.0;  ///< of the paper's tables under the prediction, 15 degrees of freedom
  Eigen::VectorXd shift;    ///< posterior mean of the nuisance parameters
  TableVector after;        ///< the prediction with that shift
};

/// Eq. SU-9.
Fit fit_tables(const Prediction& prediction, const PaperTables& paper, const Nuisance& nuisance);

}  // namespace stillhand::study
