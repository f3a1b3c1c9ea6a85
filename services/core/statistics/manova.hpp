// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

namespace stillhand::statistics {

/// A balanced two-way design; rows of the observations in the order
/// row = (subject * conditions + condition) * replicates + replicate.
struct ManovaLayout {
  Eigen::Index subjects = 0;    ///< at least 2
  Eigen::Index conditions = 0;  ///< at least 2
  Eigen::Index replicates = 1;  ///< observations a cell, at least 1
};

/// An F statistic with its upper tail.
struct FTest {
  double f = 0.0;
  double numerator_df = 0.0;    ///< [-]
  double denominator_df = 0.0;  ///< [-] need not be whole
  double p = 1.0;               ///< [-] from the tail itself; below the smallest double 0
};

/// One effect, for all metrics together.
struct MultivariateTest {
  double wilks_lambda = 1.0;  ///< det E / det(E + H), Eq. ST-8
  FTest wilks;                ///< Rao's approximation, Eq. ST-9; exact for p or q of 1 or 2
  double pillai_trace = 0.0;  ///< tr H (H + E)^-1, Eq. ST-10
  FTest pillai;               ///< Eq. ST-10
};

struct Manova {
  double error_df = 0.0;  ///< v [-]
  MultivariateTest condition;
  MultivariateTest subject;
  /// Condition x subject; only with two or more replicates.  No interaction can be tested with one
  /// trial a cell: there it is what the error is made of.
  std::optional<MultivariateTest> interaction;
};

/// Two-way multivariate analysis of variance, README Eq. ST-7 to ST-10, fixed effects:
///
///   y = grand mean + condition + subject (+ interaction) + e
///
/// Without replicates the error is the condition x subject residual, v = (S-1)(C-1), and the model
/// is of main effects alone.  With replicates the error is the spread within cells, v = SC(R-1).
/// For what that means when subjects are a sample of people see the README.
/// Results do not depend on units, scale or order of the metrics.
/// Source: Rencher, Methods of Multivariate Analysis, 2nd ed., 6.1 and 6.5; Rao, Bull. Int. Stat.
/// Inst. 33(2), 1951.  Pure.
/// @param observations  [subjects*conditions*replicates x p metrics], any units
/// @throws stillhand::ConfigError when sizes disagree, a value isn't finite, the error has fewer
///         degrees of freedom than there are metrics, or the residuals of the metrics don't vary
///         or are linearly dependent.
Manova two_way_manova(const Eigen::MatrixXd& observations, const ManovaLayout& layout);

}  // namespace stillhand::statistics
