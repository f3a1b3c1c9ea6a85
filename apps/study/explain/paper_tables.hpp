// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

namespace stillhand::study {

/// What Tables I and II say, as one vector [mm, -, Hz], METHOD Eq. SU-7: for each metric the mean
/// of A, of B - A and of C - B, then the logarithm of the standard deviation of A - B and of B - C
/// between subjects.
inline constexpr Eigen::Index kTableFigures = 15;
inline constexpr Eigen::Index kTableMeans = 9;
using TableVector = Eigen::Matrix<double, kTableFigures, 1>;
using TableMatrix = Eigen::Matrix<double, kTableFigures, kTableFigures>;

/// "B-C rms_error" and so on, as in explanation.json.
const std::array<std::string, kTableFigures>& table_figure_names();

/// The paper's.  @param unit_mm  of its RMS error
struct PaperTables {
  TableVector values;
  TableMatrix uncertainty;     ///< covariance of the printed figures themselves, Eq. SU-7
  TableVector per_log_unit;    ///< change of the values with the logarithm of the unit
  TableVector standard_error;  ///< of each figure, from the p-values and 11 degrees of freedom
};
PaperTables paper_tables(double unit_mm);

/// Standard deviation of n paired differences from their mean and the p of their t-test:
/// |d| sqrt(n) / t, t = t_{n-1}(p/2).
double deviation_from_p(double mean_difference, double p, int subjects);

inline constexpr int kPaperSubjects = 12;
/// Deviation of the logarithm of the unit: the dwell ratios give 5.3 to 5.8 mm.
inline constexpr double kLogUnitDeviation = 0.05;

}  // namespace stillhand::study
