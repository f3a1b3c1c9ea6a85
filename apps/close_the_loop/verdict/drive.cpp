// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/drive.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/libraries/measurement/read.hpp"
#include "services/core/contract/expects.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::close_the_loop {
namespace {

using Values = std::vector<double>;

// An encoder of 4096 counts tells accelerations up to here; the motion is below 4 Hz.
constexpr double kBand_hz = 15.0;
constexpr std::size_t kEdge = 1000;  // [samples] the filter's own start and end

Values zero_phase(const Values& x) {
  Values y = x;
  for (int way = 0; way < 2; ++way) {
    signal::Butterworth low(4, kBand_hz, kControlRateHz);
    for (double& value : y) value = low.step(value);
    std::ranges::reverse(y);
  }
  return y;
}

Values rate_of(const Values& x) {
  Values v(x.size(), 0.0);
  for (std::size_t n = 1; n + 1 < x.size(); ++n) {
    v[n] = 0.5 * (x[n + 1] - x[n - 1]) * kControlRateHz;
  }
  return v;
}

// Every signal of Eq. CL-5 at 1 kHz, in the same band.
struct DriveSignals {
  Values theta, omega, alpha, sign, force, motor;

  explicit DriveSignals(const recording::Recording& trial) {
    const auto column = [&](const char* name) -> const Values& {
      const recording::Column* found = trial.find(name);
      STILLHAND_EXPECTS(found != nullptr);
      return found->values;
    };
    theta = zero_phase(column("theta"));
    omega = rate_of(theta);
    alpha = rate_of(omega);
    force = zero_phase(column("f"));
    motor = zero_phase(column("f_motor"));
    constexpr double kTransition_rad_s = 0.03;
    sign = omega;
    for (double& value : sign) value = std::tanh(value / kTransition_rad_s);
    sign = zero_phase(sign);
  }
};

// RMS that least squares of Eq. CL-5 leaves.
double residual(const DriveSignals& s, std::size_t motor_late, std::size_t cell_late) {
  constexpr std::size_t kEvery = 7;
  constexpr Eigen::Index kColumns = 5;
  Eigen::Matrix<double, kColumns, kColumns> gram =
      Eigen::Matrix<double, kColumns, kColumns>::Zero();
  Eigen::Matrix<double, kColumns, 1> right = Eigen::Matrix<double, kColumns, 1>::Zero();
  double square = 0.0;
  double count = 0.0;
  for (std::size_t n = kEdge; n + kEdge < s.force.size(); n += kEvery) {
    const std::size_t then = n - cell_late;
    const Eigen::Matrix<double, kColumns, 1> row{s.alpha[then], s.omega[then], s.sign[then],
                                                 s.motor[then - motor_late], 1.0};
    gram += row * row.transpose();
    right += row * s.force[n];
    square += s.force[n] * s.force[n];
    count += 1.0;
  }
  if (count == 0.0) return 0.0;
  const Eigen::Matrix<double, kColumns, 1> x = gram.ldlt().solve(right);
  return std::sqrt(std::max(square - x.dot(right), 0.0) / count);
}

}  // namespace

std::optional<Latency> measure_latency(const recording::Recording& trial,
                                       const DeclaredDrive& declared) {
  constexpr double kLeastMotor_n = 0.5;
  constexpr std::size_t kLongest_ticks = 120;
  if (trial.row_count() < 4 * kEdge) return std::nullopt;
  const DriveSignals signals(trial);
  double square = 0.0;
  for (const double force : signals.motor) square += force * force;
  if (square < kLeastMotor_n * kLeastMotor_n * static_cast<double>(signals.motor.size())) {
    return std::nullopt;
  }
  const auto usual = static_cast<std::size_t>(std::lround(declared.motor_delay_s * kControlRateHz));
  Latency best;
  best.residual_n = std::numeric_limits<double>::infinity();
  for (std::size_t late = 0; late <= kLongest_ticks; ++late) {
    const double seconds = static_cast<double>(late) * kControlPeriod_s;
    const double as_motor = residual(signals, late, 0);
    if (as_motor < best.residual_n) best = {seconds, 0.0, 0.0, as_motor};
    const double as_cell = residual(signals, usual, late);
    if (as_cell < best.residual_n) best = {declared.motor_delay_s, seconds, 0.0, as_cell};
  }
  if (!std::isfinite(best.residual_n)) return std::nullopt;
  const double before = residual(signals, usual, 0);
  best.explained_n = std::sqrt(std::max(before * before - best.residual_n * best.residual_n, 0.0));
  return best;
}

diagnosis::Measurement drive_measurement(const recording::Recording& trial,
                                         const DeclaredDrive& declared) {
  constexpr std::size_t kEvery = 10;
  STILLHAND_EXPECTS(trial.row_count() > 4 * kEdge);
  const DriveSignals signals(trial);
  const auto motor_late =
      static_cast<std::size_t>(std::lround(declared.motor_delay_s * kControlRateHz));
  diagnosis::Measurement out;
  out.source = trial.source;
  out.rate_hz = kControlRateHz / kEvery;
  out.channels = {
      {"alpha", "rad/s^2", {}}, {"omega", "rad/s", {}}, {"theta", "rad", {}}, {"f_drive", "N", {}}};
  for (std::size_t n = kEdge; n + kEdge < trial.row_count(); n += kEvery) {
    const double force_n = signals.force[n] + signals.motor[n - motor_late] -
                           declared.stick.coulomb_friction_n * signals.sign[n];
    const double row[] = {signals.alpha[n], signals.omega[n], signals.theta[n], force_n};
    for (std::size_t c = 0; c < out.channels.size(); ++c) out.channels[c].values.push_back(row[c]);
  }
  const std::size_t samples = out.channels.front().values.size();
  out.weight.assign(samples, 1.0);
  out.stretches = {{0, samples, trial.time_s[kEdge]}};
  return out;
}

diagnosis::Diagnosis diagnose_drive(const std::vector<const recording::Recording*>& trials,
                                    const DeclaredDrive& declared,
                                    const diagnosis::DiagnoseOptions& options) {
  diagnosis::DiagnoseOptions own = options;
  own.inputs = {"alpha", "omega"};
  own.output = "f_drive";
  own.model = diagnosis::ModelClass::kLinear;
  own.search.most_effects = 1;
  own.least_force_n = std::max(options.least_force_n, declared.stick.coulomb_friction_n);
  std::vector<diagnosis::Measurement> parts;
  for (const recording::Recording* trial : trials) {
    parts.push_back(drive_measurement(*trial, declared));
  }
  return diagnosis::diagnose(
      parts.size() == 1 ? std::move(parts.front()) : measurement::join(std::move(parts)), own);
}

}  // namespace stillhand::close_the_loop
