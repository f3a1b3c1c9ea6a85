// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/paper_tables.hpp"

#include <cmath>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::study {
namespace {

// What is uncertain in the printed mean of one condition, besides its subjects, Eq. SU-7.
// All are printed in steps of 0.01.
constexpr double kPrintedStep = 0.01;
// RMS error: the size that the dwell ratio implies, for a Gaussian error, is 5.8, 5.3 and 5.4 mm a
// unit in A, B and C, 5 % of it.  No population of this simulator gives three different ratios.
constexpr double kRmsShare = 0.05;
// Dwell ratio and f_c: the abstract of the journal's version has +32 % where the text has +35 %,
// and 0.11 and 0.15 Hz where the text has 0.10 and 0.14 Hz.
constexpr double kDwellRevision = 0.005;
constexpr double kCrossoverRevision_hz = 0.006;

// Variance of the printed mean of metric k.
double variance_of(std::size_t k, double mean, double unit) {
  const double printed = unit * kPrintedStep / std::sqrt(12.0);
  const double other = k == 0 ? kRmsShare * mean : k == 1 ? kDwellRevision : kCrossoverRevision_hz;
  return printed * printed + other * other;
}

}  // namespace

const std::array<std::string, kTableFigures>& table_figure_names() {
  static const auto kNames = [] {
    std::array<std::string, kTableFigures> names;
    std::size_t at = 0;
    for (const char* what : {"A ", "A-B ", "B-C ", "A-B sd ", "B-C sd "}) {
      for (const auto& metric : session::kMetrics) {
        names[at++] = std::string(what) + metric.name;
      }
    }
    return names;
  }();
  return kNames;
}

double deviation_from_p(double mean_difference, double p, int subjects) {
  const double t = statistics::t_upper_quantile(p / 2.0, subjects - 1.0);
  return std::abs(mean_difference) * std::sqrt(static_cast<double>(subjects)) / t;
}

PaperTables paper_tables(double unit_mm) {
  PaperTables out;
  out.uncertainty.setZero();
  out.per_log_unit.setZero();
  out.standard_error.setZero();
  const double n = kPaperSubjects;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const auto& metric = session::kMetrics[at];
    const double unit = k == 0 ? unit_mm : 1.0;
    const double ab = unit * (metric.paper->b - metric.paper->a);
    const double bc = unit * (metric.paper->c - metric.paper->b);
    const double sd_ab = deviation_from_p(ab, metric.paper->p_ab, kPaperSubjects);
    const double sd_bc = deviation_from_p(bc, metric.paper->p_bc, kPaperSubjects);
    out.values[k] = unit * metric.paper->a;
    out.values[3 + k] = ab;
    out.values[6 + k] = bc;
    out.values[9 + k] = std::log(sd_ab);
    out.values[12 + k] = std::log(sd_bc);
    // Differences share the uncertainty of a condition; a deviation goes with its difference.
    const double of_a = variance_of(at, unit * metric.paper->a, unit);
    const double of_b = variance_of(at, unit * metric.paper->b, unit);
    const double of_c = variance_of(at, unit * metric.paper->c, unit);
    // A, B - A, C - B, ln s of A-B and of B-C as functions of the three conditions.
    Eigen::Matrix<double, 5, 3> of;
    of << 1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, 0, 0, 0, 0;
    of.row(3) = of.row(1) / ab;
    of.row(4) = of.row(2) / bc;
    Eigen::Matrix3d conditions = Eigen::Vector3d(of_a, of_b, of_c).asDiagonal();
    // f_c of B and of C were revised by the same amount.
    if (k == 2) conditions(1, 2) = conditions(2, 1) = kCrossoverRevision_hz * kCrossoverRevision_hz;
    const Eigen::Matrix<double, 5, 5> own = of * conditions * of.transpose();
    for (Eigen::Index i = 0; i < 5; ++i) {
      for (Eigen::Index j = 0; j < 5; ++j) out.uncertainty(3 * i + k, 3 * j + k) = own(i, j);
    }
    if (k == 0) {
      out.per_log_unit[0] = unit * metric.paper->a;
      out.per_log_unit[3] = ab;
      out.per_log_unit[6] = bc;
      out.per_log_unit[9] = out.per_log_unit[12] = 1.0;
    }
    // The tables give no spread of A itself: that of A - B stands for it.
    out.standard_error[k] = out.standard_error[3 + k] = sd_ab / std::sqrt(n);
    out.standard_error[6 + k] = sd_bc / std::sqrt(n);
    out.standard_error[9 + k] = out.standard_error[12 + k] = 1.0 / std::sqrt(2.0 * (n - 1.0));
  }
  return out;
}

}  // namespace stillhand::study
