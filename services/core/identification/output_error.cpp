// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/output_error.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/identification/polynomial.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::identification {
namespace {

constexpr int kMaxIterations = 100;
// Two steps in a row that gain less than this share of V end the search.  A parameter one standard
// error off costs V / N; at the paper's N = 6000 this is the cost of less than a hundredth of one.
constexpr double kSmallGain = 1e-8;
constexpr double kLargestDamping = 1e10;

// Sample from which the error counts: a record that begins in mid-motion has a transient first.
std::size_t first_judged(const Record& record) {
  return std::min(static_cast<std::size_t>(record.rate_hz), record.size() / 10);
}

DifferenceModel with(const DifferenceModel& model, const Eigen::VectorXd& parameters) {
  DifferenceModel out = model;
  const auto split = static_cast<std::ptrdiff_t>(model.numerator.size());
  std::copy(parameters.begin(), parameters.begin() + split, out.numerator.begin());
  std::copy(parameters.begin() + split, parameters.end(), out.denominator.begin() + 1);
  return out;
}

Eigen::VectorXd parameters_of(const DifferenceModel& model) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(2 * model.order() + 1));
  std::copy(model.numerator.begin(), model.numerator.end(), out.begin());
  std::copy(model.denominator.begin() + 1, model.denominator.end(),
            out.begin() + static_cast<std::ptrdiff_t>(model.numerator.size()));
  return out;
}

// f - f_sim on the judged samples.
Eigen::VectorXd residual(const Record& record, const DifferenceModel& model) {
  const std::vector<double> run = signal::simulated(model, record.acceleration_m_s2);
  const auto first = static_cast<Eigen::Index>(first_judged(record));
  const auto count = static_cast<Eigen::Index>(run.size()) - first;
  return Eigen::Map<const Eigen::VectorXd>(record.force_n.data() + first, count) -
         Eigen::Map<const Eigen::VectorXd>(run.data() + first, count);
}

// df_sim/d(c, d), Eq. ID-7: one filtering of a and one of f_sim by 1/D, then shifts.
Eigen::MatrixXd sensitivities(const Record& record, const DifferenceModel& model) {
  DifferenceModel inverse = model;
  std::fill(inverse.numerator.begin(), inverse.numerator.end(), 0.0);
  inverse.numerator[0] = 1.0;
  const auto run = signal::simulated(model, record.acceleration_m_s2);
  const auto by_c = signal::simulated(inverse, record.acceleration_m_s2);
  const auto by_d = signal::simulated(inverse, run);
  const std::size_t first = first_judged(record);
  const std::size_t order = model.order();
  Eigen::MatrixXd out(static_cast<Eigen::Index>(record.size() - first),
                      static_cast<Eigen::Index>(2 * order + 1));
  for (std::size_t n = first; n < record.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n - first);
    for (std::size_t i = 0; i <= order; ++i) {
      out(row, static_cast<Eigen::Index>(i)) = n >= i ? by_c[n - i] : 0.0;
      if (i > 0) out(row, static_cast<Eigen::Index>(order + i)) = n >= i ? -by_d[n - i] : 0.0;
    }
  }
  return out;
}

// Poles on or outside the unit circle to the conjugate reciprocal; on it, slightly inside.
DifferenceModel stabilised(const DifferenceModel& model) {
  if (signal::is_stable(model)) return model;
  auto all = signal::poles(model);
  for (auto& pole : all) {
    if (std::abs(pole) >= 1.0) pole = 1.0 / std::conj(pole);
    if (std::abs(pole) > 0.999) pole *= 0.999 / std::abs(pole);
  }
  DifferenceModel out = model;
  const Polynomial monic = from_roots(all);
  std::reverse_copy(monic.begin(), monic.end(), out.denominator.begin());
  return out;
}

struct Minimum {
  DifferenceModel model;
  double cost;
  int iterations;
  bool converged;
};

// Levenberg-Marquardt; columns scaled to norm 1, so that one damping suits both units.
Minimum minimised(const Record& record, const DifferenceModel& start) {
  Minimum now{stabilised(start), 0.0, 0, false};
  now.cost = residual(record, now.model).squaredNorm();
  double damping = 1e-3;
  int small_gains = 0;
  while (now.iterations < kMaxIterations && !now.converged) {
    Eigen::MatrixXd jacobian = sensitivities(record, now.model);
    const Eigen::RowVectorXd norms = jacobian.colwise().norm().cwiseMax(1e-300);
    jacobian.array().rowwise() /= norms.array();
    const Eigen::Index columns = jacobian.cols();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian);
    const Eigen::VectorXd rotated = qr.householderQ().adjoint() * residual(record, now.model);
    Eigen::MatrixXd damped = Eigen::MatrixXd::Zero(2 * columns, columns);
    damped.topRows(columns) = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * columns);
    right.head(columns) = rotated.head(columns);
    bool improved = false;
    while (!improved && damping < kLargestDamping) {
      damped.bottomRows(columns).diagonal().setConstant(std::sqrt(damping));
      const Eigen::VectorXd step = signal::least_squares(damped, right);
      const DifferenceModel next =
          with(now.model,
               parameters_of(now.model) + (step.array() / norms.transpose().array()).matrix());
      const double cost = signal::is_stable(next) ? residual(record, next).squaredNorm() : NAN;
      improved = cost < now.cost;
      if (!improved) {
        damping *= 10.0;
        continue;
      }
      small_gains = now.cost - cost < kSmallGain * now.cost ? small_gains + 1 : 0;
      now.model = next;
      now.cost = cost;
      ++now.iterations;
      damping = std::max(damping * 0.1, 1e-12);
    }
    now.converged = !improved || small_gains >= 2;
  }
  return now;
}

}  // namespace

OutputErrorFit refine_output_error(const Record& record, const DifferenceModel& start) {
  check(record);
  if (!signal::well_formed(start) || start.rate_hz != record.rate_hz) {
    throw ConfigError("identification.start", "a model at " + std::to_string(start.rate_hz) + " Hz",
                      "a well formed one at " + std::to_string(record.rate_hz) + " Hz");
  }
  if (record.size() < 10 * (2 * start.order() + 1)) {
    throw ConfigError("recording", std::to_string(record.size()) + " samples",
                      std::to_string(10 * (2 * start.order() + 1)) + " or more");
  }
  const std::size_t split = record.size() - record.size() / 4;
  const Minimum seen = minimised(part(record, 0, split), start);
  const double start_cost = residual(record, stabilised(start)).squaredNorm();
  // What the first three quarters found is next to what the whole will find, as a rule.
  const bool nearer = residual(record, seen.model).squaredNorm() < start_cost;
  const Minimum all = minimised(record, nearer ? seen.model : start);
  const auto judged = static_cast<double>(record.size() - first_judged(record));
  OutputErrorFit fit;
  fit.model = all.model;
  fit.heldout = quality(seen.model, record, split);
  fit.converged = all.converged;
  fit.start_rms_n = std::sqrt(start_cost / judged);
  fit.rms_n = std::sqrt(all.cost / judged);
  return fit;
}

}  // namespace stillhand::identification
