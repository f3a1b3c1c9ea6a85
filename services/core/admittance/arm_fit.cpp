// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/arm_fit.hpp"

#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::admittance {
namespace {

using Complex = std::complex<double>;

// Eq. AD-12: a parameter is exp(x) times the mean arm's value; a gain of the reflex, which may be
// 0, is x times these.
constexpr double kReflexScale_n_m = 100.0;
constexpr double kReflexScale_n_s_m = 10.0;
// Eq. AD-12: standard deviation of the weak prior of x, a factor of 4.5 either way; it keeps a
// direction that the data do not determine from running away.
constexpr double kPrior = 1.5;
// Eq. AD-14: a parameter of which half, or half of the scale of a gain, is uncertain.
constexpr double kUndetermined = 0.5;
// Eq. AD-15: 99 % quantile of chi^2 with 4 degrees of freedom.
constexpr double kReflexEvidence = 13.28;
constexpr int kReweightings = 6;

bool is_gain(ArmParameter p) { return p == kReflexStiffness || p == kReflexDamping; }

double scale_of(ArmParameter p) {
  if (p == kReflexStiffness) return kReflexScale_n_m;
  if (p == kReflexDamping) return kReflexScale_n_s_m;
  return mean_arm()[p];
}

double value_at(ArmParameter p, double x) {
  return is_gain(p) ? scale_of(p) * x : scale_of(p) * std::exp(x);
}
double number_of(ArmParameter p, double value) {
  return is_gain(p) ? value / scale_of(p) : std::log(value / scale_of(p));
}
double slope_at(ArmParameter p, double value) { return is_gain(p) ? scale_of(p) : value; }

// One measured line: the error is `admittance` - 1/Z, or force + Z position - H.
struct Line {
  double frequency_hz = 0.0;
  bool of_force = false;  // a line of the motor's force
  Complex admittance;
  Complex force, position;                         // F/A, X/A
  double variance = 0.0, position_variance = 0.0;  // C_Y or C_FF; C_XX
  Complex covariance;                              // C_XF

  [[nodiscard]] Complex error(const ArmValues& arm) const {
    const ArmResponse at = arm_response(arm, frequency_hz);
    if (of_force) return admittance - 1.0 / at.impedance;
    return force + at.impedance * position - at.feedthrough;
  }
  // E|error|^2 at the true arm.
  [[nodiscard]] double variance_at(const ArmValues& arm) const {
    if (of_force) return variance;
    const Complex z = arm_response(arm, frequency_hz).impedance;
    const double sum = variance + std::norm(z) * position_variance + 2.0 * (z * covariance).real();
    // The parts nearly cancel where the hand's own force is most of the noise; rounding may not.
    return std::max(sum, 1e-9 * variance);
  }
};

void check(bool good, const char* what) {
  if (!good) throw ConfigError("lines", what, "a positive finite variance at each line");
}

std::vector<Line> lines_of(const LineEstimates& estimates) {
  std::vector<Line> out;
  for (const LineResponse& y : estimates.admittance) {
    check(y.variance > 0.0 && std::isfinite(y.variance), "admittance without a variance");
    Line line;
    line.frequency_hz = y.frequency_hz;
    line.of_force = true;
    line.admittance = y.response;
    line.variance = y.variance;
    out.push_back(line);
  }
  for (std::size_t k = 0; k < estimates.feedthrough_to_force.size(); ++k) {
    const LineResponse& f = estimates.feedthrough_to_force[k];
    check(f.variance > 0.0 && std::isfinite(f.variance), "feedthrough without a variance");
    Line line;
    line.frequency_hz = f.frequency_hz;
    line.force = f.response;
    line.variance = f.variance;
    line.position = estimates.feedthrough_to_position[k].response;
    line.position_variance = estimates.feedthrough_to_position[k].variance;
    line.covariance = estimates.position_force_covariance[k];
    out.push_back(line);
  }
  return out;
}

using Numbers = Eigen::VectorXd;
using Jacobian = Eigen::MatrixXd;

// The weighted errors as ceres::TinySolver wants them; the prior's follow.
class Problem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Problem(const std::vector<Line>& lines, std::vector<ArmParameter> fitted, const ArmValues& start)
      : lines_(lines), fitted_(std::move(fitted)), start_(start) {
    reweight(start);
  }

  void reweight(const ArmValues& at) {
    weights_.clear();
    for (const Line& line : lines_) weights_.push_back(std::sqrt(2.0 / line.variance_at(at)));
  }
  [[nodiscard]] int rows() const { return 2 * static_cast<int>(lines_.size()); }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(fitted_.size()); }
  [[nodiscard]] int NumResiduals() const { return rows() + NumParameters(); }

  [[nodiscard]] ArmValues values(const Numbers& x) const {
    ArmValues out = start_;
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      out[fitted_[i]] = value_at(fitted_[i], x[static_cast<Eigen::Index>(i)]);
    }
    return out;
  }
  [[nodiscard]] Numbers numbers(const ArmValues& at) const {
    Numbers out(NumParameters());
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      out[static_cast<Eigen::Index>(i)] = number_of(fitted_[i], at[fitted_[i]]);
    }
    return out;
  }
  // Of the data alone.
  [[nodiscard]] Numbers errors(const Numbers& x) const {
    const ArmValues at = values(x);
    Numbers out(rows());
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const Complex e = weights_[k] * lines_[k].error(at);
      out[static_cast<Eigen::Index>(2 * k)] = e.real();
      out[static_cast<Eigen::Index>(2 * k + 1)] = e.imag();
    }
    return out;
  }
  [[nodiscard]] Jacobian slopes(const Numbers& x) const {
    constexpr double kStep = 1e-5;  // of the third root of the rounding
    Jacobian out(rows(), x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Numbers up = x;
      Numbers down = x;
      up[i] += kStep;
      down[i] -= kStep;
      out.col(i) = (errors(up) - errors(down)) / (2.0 * kStep);
    }
    return out;
  }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    const Numbers x = Eigen::Map<const Numbers>(parameters, NumParameters());
    Eigen::Map<Numbers> r(residuals, NumResiduals());
    r << errors(x), (x - prior()) / kPrior;
    if (jacobian != nullptr) {
      Eigen::Map<Jacobian> j(jacobian, NumResiduals(), NumParameters());
      j << slopes(x), Jacobian::Identity(x.size(), x.size()) / kPrior;
    }
    return r.allFinite();
  }

 private:
  [[nodiscard]] Numbers prior() const { return numbers(mean_arm()); }

  const std::vector<Line>& lines_;
  std::vector<ArmParameter> fitted_;
  ArmValues start_;
  std::vector<double> weights_;
};

struct Solution {
  ArmValues values{};
  Numbers x;
  double chi2 = std::numeric_limits<double>::infinity();
};

Solution solve(Problem& problem, const ArmValues& start) {
  Solution out;
  out.x = problem.numbers(start);
  for (int i = 0; i < kReweightings; ++i) {
    ceres::TinySolver<Problem> solver;
    solver.options.max_num_iterations = 60;
    Eigen::VectorXd x = out.x;
    solver.Solve(problem, &x);
    if (!x.allFinite()) break;
    out.x = x;
    out.values = problem.values(x);
    problem.reweight(out.values);
  }
  out.chi2 = problem.errors(out.x).squaredNorm();
  return out;
}

std::vector<ArmParameter> parameters(bool reflex) {
  std::vector<ArmParameter> out;
  const std::size_t count = reflex ? kArmParameters : kReflexStiffness;
  for (std::size_t i = 0; i < count; ++i) out.push_back(static_cast<ArmParameter>(i));
  return out;
}

// Inverse of J'J with its smallest directions kept: they become large, never wrong.
Eigen::MatrixXd inverse_information(const Jacobian& slopes, double& condition) {
  const auto [u, s, v] = signal::singular_vectors(slopes);
  condition = s[0] / s[s.size() - 1];
  const Numbers floor = s.cwiseMax(1e-12 * s[0]);
  return v * floor.cwiseAbs2().cwiseInverse().asDiagonal() * v.transpose();
}

// Eqs. AD-13 and AD-14.
ArmFit described(const Problem& problem, const Solution& solution,
                 const std::vector<ArmParameter>& fitted, double nu) {
  ArmFit out;
  out.values = solution.values;
  out.fitted = fitted;
  out.degrees = problem.rows() - problem.NumParameters();
  out.misfit = solution.chi2 * (nu - 1.0) / (nu * static_cast<double>(out.degrees));
  const Eigen::MatrixXd covariance =
      nu / (nu - 2.0) * inverse_information(problem.slopes(solution.x), out.condition);
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double error = std::sqrt(covariance(row, row));
    out.standard_error[fitted[i]] = error * slope_at(fitted[i], out.values[fitted[i]]);
    if (error > kUndetermined) out.undetermined.push_back(fitted[i]);
    for (std::size_t j = 0; j < fitted.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      out.correlation.push_back(covariance(row, column) /
                                std::sqrt(covariance(row, row) * covariance(column, column)));
    }
  }
  return out;
}

void check_count(std::size_t lines, std::size_t parameters, double nu) {
  if (2 * lines <= parameters || !(nu > 2.0)) {
    throw ConfigError("lines", std::to_string(lines),
                      "more than " + std::to_string(parameters / 2) +
                          " lines of a record of four periods or more");
  }
}

ArmFit fitted_to(const std::vector<Line>& lines, const std::vector<ArmParameter>& fitted,
                 const std::vector<ArmValues>& starts, double nu, double& chi2) {
  check_count(lines.size(), fitted.size(), nu);
  ArmFit best;
  chi2 = std::numeric_limits<double>::infinity();
  for (const ArmValues& start : starts) {
    Problem problem(lines, fitted, start);
    const Solution solution = solve(problem, start);
    if (!(solution.chi2 < chi2)) continue;
    chi2 = solution.chi2;
    best = described(problem, solution, fitted, nu);
  }
  if (!std::isfinite(chi2)) {
    throw ConfigError("lines", "no finite fit", "responses of an arm on a stick");
  }
  return best;
}

// A second start: from the stiff arm alone the fit of one that gives way can end in a local
// minimum.
ArmValues soft_arm() {
  ArmValues arm = mean_arm();
  for (const ArmParameter p : {kArmStiffness, kGripStiffness}) arm[p] *= 0.4;
  for (const ArmParameter p : {kArmDamping, kGripDamping}) arm[p] *= 0.6;
  return arm;
}

}  // namespace

ArmValues mean_arm() noexcept {
  return {30.0, 400.0, 12280.0, 1.1, 15.0, 1850.0, 0.4, 14.7, 3840.0, 0.0, 0.0, 0.035, 2.2};
}

ArmFit fit_arm(const LineEstimates& estimates) {
  const std::vector<Line> lines = lines_of(estimates);
  const auto nu = static_cast<double>(estimates.neighbours);
  double chi2_without = 0.0;
  ArmFit without = fitted_to(lines, parameters(false), {mean_arm(), soft_arm()}, nu, chi2_without);
  std::vector<ArmValues> starts;
  for (const double gain_n_m : {50.0, 300.0}) {
    for (const double delay_s : {0.03, 0.06}) {
      ArmValues start = without.values;
      start[kReflexStiffness] = gain_n_m;
      start[kReflexDamping] = 0.1 * gain_n_m;
      start[kReflexDelay] = delay_s;
      starts.push_back(start);
    }
  }
  double chi2_with = 0.0;
  ArmFit with = fitted_to(lines, parameters(true), starts, nu, chi2_with);
  const double evidence = (chi2_without - chi2_with) * (nu - 1.0) / nu;
  with.reflex = evidence > kReflexEvidence;
  with.reflex_evidence = without.reflex_evidence = evidence;
  return with.reflex ? with : without;
}

}  // namespace stillhand::admittance
