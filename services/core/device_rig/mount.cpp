// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/mount.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "services/core/contract/config_error.hpp"

namespace stillhand::device_rig {
namespace {

constexpr std::size_t kAxes = 3;
constexpr double kTolerance = 1e-3;

double product(const std::array<double, kAxes>& a, const std::array<double, kAxes>& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

Mount::Mount(const std::string& key, const std::string& text) {
  const std::string want =
      "nine numbers, the rows forward, right and up in the sensor's axes, each of length 1 and at "
      "right angles: 1 0 0, 0 1 0, 0 0 1";
  std::string plain = text;
  std::ranges::replace(plain, ',', ' ');
  std::istringstream numbers(plain);
  for (auto& row : rows_) {
    for (double& each : row) {
      if (!(numbers >> each)) throw ConfigError(key, text, want);
    }
  }
  std::string rest;
  if (numbers >> rest) throw ConfigError(key, text, want);
  for (std::size_t i = 0; i < kAxes; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      const double off = product(rows_[i], rows_[k]) - (i == k ? 1.0 : 0.0);
      if (!(std::abs(off) <= kTolerance)) throw ConfigError(key, text, want);
    }
  }
}

// Every axis holds a share of every channel, even of 0: 0 times NaN is NaN, so a reading without a
// value leaves no axis with one.
std::array<double, 3> Mount::turned(const std::array<double, 3>& reading) const noexcept {
  return {product(rows_[0], reading), product(rows_[1], reading), product(rows_[2], reading)};
}

}  // namespace stillhand::device_rig
