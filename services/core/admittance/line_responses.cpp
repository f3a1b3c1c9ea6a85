// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/line_responses.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::admittance {
namespace {

using Complex = std::complex<double>;

constexpr std::int64_t kFewestPeriods = 4;

void check_signal(const std::string& name, const std::vector<double>& values, std::size_t count) {
  if (values.size() != count) {
    throw ConfigError("recording, " + name, std::to_string(values.size()) + " samples",
                      std::to_string(count) + ", as many as of motor_force_n");
  }
  if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
    throw ConfigError("recording, " + name, "a value that is not finite", "finite values");
  }
}

std::int64_t periods_of(const FreeStickRecord& record, std::int64_t samples_per_period) {
  const std::size_t count = record.motor_force_n.size();
  check_signal("motor force", record.motor_force_n, count);
  check_signal("acceleration", record.acceleration_m_s2, count);
  check_signal("displacement", record.displacement_m, count);
  check_signal("hand force", record.hand_force_n, count);
  const auto samples = static_cast<std::int64_t>(count);
  if (samples % samples_per_period != 0 || samples / samples_per_period < kFewestPeriods) {
    throw ConfigError(
        "recording, motor force", std::to_string(count) + " samples",
        "whole periods of " + std::to_string(samples_per_period) + " samples, four or more");
  }
  return samples / samples_per_period;
}

// Lines of input, displacement and hand force: the excited one and its neighbours.
struct Lines {
  double frequency_hz = 0.0;
  double periods = 0.0;
  Eigen::Vector3cd excited;  // U, X, F
  Eigen::Matrix3Xcd noise;   // the same of the neighbours
};

Lines lines_at(const FreeStickRecord& record, const std::vector<double>& input,
               std::int64_t harmonic, std::int64_t periods) {
  const auto all_at = [&](std::int64_t cycles) {
    return Eigen::Vector3cd(signal::line_at(input, cycles),
                            signal::line_at(record.displacement_m, cycles),
                            signal::line_at(record.hand_force_n, cycles));
  };
  const double duration_s = static_cast<double>(input.size()) / record.rate_hz;
  const std::int64_t middle = harmonic * periods;
  Lines out;
  out.frequency_hz = static_cast<double>(middle) / duration_s;
  out.periods = static_cast<double>(periods);
  out.excited = all_at(middle);
  out.noise.resize(3, 2 * (periods - 1));
  for (std::int64_t j = 1; j < periods; ++j) {
    out.noise.col(2 * j - 2) = all_at(middle - j);
    out.noise.col(2 * j - 1) = all_at(middle + j);
  }
  return out;
}

// R = a / b with noise, Eqs. AD-5 to AD-8; a and b are weighted sums of U, X and F.
LineResponse ratio(const Lines& lines, const Eigen::RowVector3cd& above,
                   const Eigen::RowVector3cd& below) {
  const Complex output = above * lines.excited;
  const Complex input = below * lines.excited;
  LineResponse out;
  out.frequency_hz = lines.frequency_hz;
  out.response = output / input;
  const Eigen::RowVectorXcd errors = (above - out.response * below) * lines.noise;
  const auto count = static_cast<double>(lines.noise.cols());
  out.variance = errors.squaredNorm() / (count * std::norm(input));
  out.radius95 = std::sqrt(out.variance * count * (std::pow(0.05, -1.0 / count) - 1.0));
  const double of_period = lines.periods * (above * lines.noise).squaredNorm() / count;
  out.coherence = std::norm(output) / (std::norm(output) + of_period);
  return out;
}

// Covariance of two outputs over one input, as Eq. AD-6.
Complex covariance(const Lines& lines, const Eigen::RowVector3cd& one,
                   const Eigen::RowVector3cd& other) {
  const Complex input = lines.excited[0];
  const auto errors = [&](const Eigen::RowVector3cd& of) -> Eigen::RowVectorXcd {
    const Eigen::RowVector3cd of_input(Complex(of * lines.excited) / input, 0.0, 0.0);
    return (of - of_input) * lines.noise;
  };
  return errors(other).dot(errors(one)) /
         (static_cast<double>(lines.noise.cols()) * std::norm(input));
}

}  // namespace

LineEstimates estimate(const FreeStickRecord& record, const Excitation& excitation) {
  const std::int64_t periods = periods_of(record, excitation.force.samples_per_period());
  const Eigen::RowVector3cd of_input(1.0, 0.0, 0.0);
  const Eigen::RowVector3cd of_displacement(0.0, 1.0, 0.0);
  const Eigen::RowVector3cd of_force(0.0, 0.0, 1.0);
  LineEstimates out;
  out.neighbours = 2 * (periods - 1);
  for (const signal::Component& component : excitation.force.components()) {
    const Lines lines = lines_at(record, record.motor_force_n, component.harmonic, periods);
    out.admittance.push_back(ratio(lines, of_displacement, -of_force));
    out.stick_per_force.push_back(ratio(lines, of_displacement, of_input));
  }
  for (const signal::Component& component : excitation.motion.components()) {
    const Lines lines = lines_at(record, record.acceleration_m_s2, component.harmonic, periods);
    out.feedthrough_to_force.push_back(ratio(lines, of_force, of_input));
    out.feedthrough_to_position.push_back(ratio(lines, of_displacement, of_input));
    out.position_force_covariance.push_back(covariance(lines, of_displacement, of_force));
  }
  return out;
}

std::vector<LineResponse> estimate_pegged(const FreeStickRecord& record,
                                          const Excitation& excitation) {
  const std::int64_t periods = periods_of(record, excitation.motion.samples_per_period());
  std::vector<LineResponse> out;
  for (const signal::Component& component : excitation.motion.components()) {
    const Lines lines = lines_at(record, record.acceleration_m_s2, component.harmonic, periods);
    out.push_back(
        ratio(lines, Eigen::RowVector3cd(0.0, 0.0, 1.0), Eigen::RowVector3cd(1.0, 0.0, 0.0)));
  }
  return out;
}

}  // namespace stillhand::admittance
