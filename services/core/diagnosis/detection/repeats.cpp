// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/repeats.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/detection/fourier_lines.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kLeastPeriodicWeight = 0.9;  // of the samples of a periodic part
constexpr double kFirstDiffers = 0.01;        // significance

// Periods of a residual, one a column; samples that don't count at their mean over the others.
struct Periods {
  Eigen::MatrixXd values;
  Eigen::VectorXd mean;
  double squares = 0.0;   // about the mean
  double compared = 0.0;  // samples less the mean's
};

Periods periods_of(const Periodicity& used, const Eigen::VectorXd& residual,
                   const std::vector<double>& weight) {
  const auto rows = static_cast<Eigen::Index>(used.period);
  const auto columns = static_cast<Eigen::Index>(used.periods);
  const auto first = static_cast<Eigen::Index>(used.first);
  Periods periods;
  periods.values = Eigen::Map<const Eigen::MatrixXd>(residual.data() + first, rows, columns);
  periods.mean.setZero(rows);
  const double* counts = weight.data() + used.first;
  for (Eigen::Index i = 0; i < rows; ++i) {
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index m = 0; m < columns; ++m) {
      if (counts[i + m * rows] > 0.0) {
        sum += periods.values(i, m);
        count += 1.0;
      }
    }
    periods.mean[i] = count > 0.0 ? sum / count : 0.0;
    for (Eigen::Index m = 0; m < columns; ++m) {
      if (!(counts[i + m * rows] > 0.0)) periods.values(i, m) = periods.mean[i];
    }
    periods.compared += std::max(count - 1.0, 0.0);
  }
  periods.squares = (periods.values.colwise() - periods.mean).squaredNorm();
  return periods;
}

// Twice the number of white lines that would spread as much: 2 (sum s)^2 / sum s^2 over lines of
// variance s, which are seen as |X|^2 with a mean of s and a mean square of 2 s^2.
double degrees_of_freedom(const std::vector<Complex>& lines, std::size_t periods) {
  double sum = 0.0;
  double square = 0.0;
  for (std::size_t j = 1; j < lines.size(); ++j) {
    if (j % periods == 0) continue;
    const double power = std::norm(lines[j]);
    sum += power;
    square += power * power;
  }
  return square > 0.0 ? 4.0 * sum * sum / square : 0.0;
}

// Does the first of several periods differ from the others by more than they differ?
bool first_differs(const Periods& periods, double freedom) {
  const Eigen::Index count = periods.values.cols();
  if (count < 3) return false;
  const Eigen::MatrixXd others = periods.values.rightCols(count - 1);
  const Eigen::VectorXd mean = others.rowwise().mean();
  const auto more = static_cast<double>(count);
  const double own = (periods.values.col(0) - mean).squaredNorm() / (1.0 + 1.0 / (more - 1.0));
  const double between = (others.colwise() - mean).squaredNorm() / (more - 2.0);
  const double a_period = freedom / (more - 1.0);
  if (!(between > 0.0) || a_period < 1.0) return false;
  return statistics::f_above(own / between, a_period, a_period * (more - 2.0)) < kFirstDiffers;
}

}  // namespace

std::optional<RepeatedResidual> repeated_residual(const Periodicity& periodicity,
                                                  const Eigen::VectorXd& residual,
                                                  const std::vector<double>& weight) {
  RepeatedResidual result;
  result.used = periodicity;
  double counted = 0.0;
  for (std::size_t n = periodicity.first; n < periodicity.end(); ++n) {
    counted += weight[n] > 0.0 ? 1.0 : 0.0;
  }
  if (counted < kLeastPeriodicWeight * static_cast<double>(periodicity.end() - periodicity.first)) {
    return {};
  }
  const auto lines_of = [](const Periods& periods) {
    return fourier_lines({periods.values.data(), periods.values.data() + periods.values.size()});
  };
  Periods periods = periods_of(result.used, residual, weight);
  result.lines = lines_of(periods);
  double freedom = degrees_of_freedom(result.lines, result.used.periods);
  if (first_differs(periods, freedom)) {
    result.repeats.first_left_out = true;
    result.used.first += result.used.period;
    --result.used.periods;
    periods = periods_of(result.used, residual, weight);
    result.lines = lines_of(periods);
    freedom = degrees_of_freedom(result.lines, result.used.periods);
  }
  if (!(periods.squares > 0.0) || freedom < 1.0) return {};
  Repeats& repeats = result.repeats;
  repeats.periods = result.used.periods;
  repeats.degrees_of_freedom = freedom;
  repeats.rms = std::sqrt(periods.squares / std::max(periods.compared, 1.0));
  const auto end = [&](double p) {
    return repeats.rms * std::sqrt(freedom / statistics::chi_squared_quantile(p, freedom));
  };
  repeats.low = end(0.975);
  repeats.high = end(0.025);
  return result;
}

}  // namespace stillhand::diagnosis
