// SPDX-License-Identifier: Apache-2.0
#include "services/core/vehicle/loop_margin.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/vehicle/vehicle.hpp"

namespace stillhand::vehicle {
namespace {

using Complex = std::complex<double>;
constexpr std::uint64_t kStream = 0x5648;  // of the draws

void check(const IdentifiedResponse& theta) {
  const auto& f = theta.frequency_hz;
  const bool rises = f.size() >= 2 && f.size() == theta.response.size() && f.front() > 0.0 &&
                     std::adjacent_find(f.begin(), f.end(), std::greater_equal<>()) == f.end();
  if (!rises || (!theta.variance.empty() && theta.variance.size() != f.size())) {
    throw ConfigError("vehicle.response", std::to_string(f.size()) + " frequencies",
                      "two or more that rise, each with a response");
  }
}

// The whole loop's response on the grid, for one gain and vehicle.
std::vector<Complex> vehicle_on(const VehicleConfig& config, const std::vector<double>& grid_hz) {
  std::vector<Complex> out;
  out.reserve(grid_hz.size());
  for (const double f : grid_hz) out.push_back(vehicle_response(config, f));
  return out;
}

std::vector<double> grid_over(const IdentifiedResponse& theta, int steps) {
  std::vector<double> grid;
  const double low = theta.frequency_hz.front();
  const double ratio = theta.frequency_hz.back() / low;
  for (int k = 0; k <= steps; ++k) {
    grid.push_back(low * std::pow(ratio, static_cast<double>(k) / steps));
  }
  return grid;
}

// Eq. VH-9: the largest positive crossing of the real axis.
Margin margin_on(const VehicleConfig& config, const std::vector<double>& grid_hz,
                 const std::vector<Complex>& vehicle, const IdentifiedResponse& theta) {
  Margin out;
  double largest = 0.0;
  Complex before;
  for (std::size_t k = 0; k < grid_hz.size(); ++k) {
    const Complex loop = vehicle[k] * theta.at(grid_hz[k]);
    if (k > 0 && (before.imag() > 0.0) != (loop.imag() > 0.0)) {
      const double part = before.imag() / (before.imag() - loop.imag());
      const double real = before.real() + part * (loop.real() - before.real());
      if (real > largest) {
        largest = real;
        out.frequency_hz = grid_hz[k - 1] + part * (grid_hz[k] - grid_hz[k - 1]);
      }
    }
    before = loop;
  }
  out.critical_gain_m_s2_rad =
      largest > 0.0 ? config.gain_m_s2_rad / largest : std::numeric_limits<double>::infinity();
  out.stable = largest < 1.0;
  return out;
}

// With a gain of 0 there is no curve whose crossings could be scaled.
VehicleConfig with_gain(VehicleConfig config) {
  if (!(config.gain_m_s2_rad > 0.0)) config.gain_m_s2_rad = 1.0;
  return config;
}

}  // namespace

Complex IdentifiedResponse::at(double f) const noexcept {
  const auto above = std::upper_bound(frequency_hz.begin(), frequency_hz.end(), f);
  if (above == frequency_hz.begin()) return response.front();
  if (above == frequency_hz.end()) return response.back();
  const auto k = static_cast<std::size_t>(above - frequency_hz.begin());
  const double part = std::log(f / frequency_hz[k - 1]) / std::log(*above / frequency_hz[k - 1]);
  return response[k - 1] + part * (response[k] - response[k - 1]);
}

Margin margin(const VehicleConfig& config, const IdentifiedResponse& theta, int steps) {
  check(theta);
  const VehicleConfig used = with_gain(config);
  const auto grid = grid_over(theta, steps);
  Margin out = margin_on(used, grid, vehicle_on(used, grid), theta);
  if (!(config.gain_m_s2_rad > 0.0)) out.stable = true;
  return out;
}

// Eq. VH-11.
GainInterval critical_gain(const VehicleConfig& config, const IdentifiedResponse& theta, int draws,
                           std::uint64_t seed) {
  check(theta);
  const VehicleConfig used = with_gain(config);
  const auto grid = grid_over(theta, 600);
  const auto vehicle = vehicle_on(used, grid);
  const double gain = margin_on(used, grid, vehicle, theta).critical_gain_m_s2_rad;
  if (theta.variance.empty() || draws < 2) return {gain, gain, gain};
  signal::Gaussian normal(seed, kStream);
  std::vector<double> gains;
  IdentifiedResponse moved = theta;
  for (int draw = 0; draw < draws; ++draw) {
    for (std::size_t k = 0; k < theta.response.size(); ++k) {
      const double scale = std::sqrt(0.5 * std::max(theta.variance[k], 0.0));
      const double real = normal();
      moved.response[k] = theta.response[k] + scale * Complex{real, normal()};
    }
    gains.push_back(margin_on(used, grid, vehicle, moved).critical_gain_m_s2_rad);
  }
  std::sort(gains.begin(), gains.end());
  const auto at = [&](double share) {
    return gains[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(gains.size() - 1)))];
  };
  return {gain, at(0.025), at(0.975)};
}

}  // namespace stillhand::vehicle
