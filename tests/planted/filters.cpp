// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/filters.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillhand::planted {
namespace {

void section(Series& values, const double (&b)[3], double a1, double a2) {
  double s1 = 0.0;
  double s2 = 0.0;
  for (double& value : values) {
    const double out = b[0] * value + s1;
    s1 = b[1] * value - a1 * out + s2;
    s2 = b[2] * value - a2 * out;
    value = out;
  }
}

void butterworth(Series& values, double rate_hz, double corner_hz, std::size_t order, bool high) {
  const double k = std::tan(std::numbers::pi * corner_hz / rate_hz);
  for (std::size_t i = 0; i < order / 2; ++i) {
    const double angle_rad = std::numbers::pi * (2.0 * static_cast<double>(i) + 1.0) /
                             (2.0 * static_cast<double>(order));
    const double damping = 2.0 * std::sin(angle_rad);
    const double norm = 1.0 / (1.0 + damping * k + k * k);
    const double a1 = 2.0 * (k * k - 1.0) * norm;
    const double a2 = (1.0 - damping * k + k * k) * norm;
    const double b0 = high ? norm : k * k * norm;
    section(values, {b0, high ? -2.0 * b0 : 2.0 * b0, b0}, a1, a2);
  }
}

}  // namespace

double mean_of(const Series& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double spread_of(const Series& values) {
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

void standardise(Series& values, double rms) {
  const double mean = mean_of(values);
  const double spread = spread_of(values);
  const double scale = spread > 0.0 ? rms / spread : 0.0;
  for (double& value : values) value = (value - mean) * scale;
}

void low_pass(Series& values, double rate_hz, double corner_hz, std::size_t order) {
  butterworth(values, rate_hz, corner_hz, order, false);
}

void high_pass(Series& values, double rate_hz, double corner_hz, std::size_t order) {
  butterworth(values, rate_hz, corner_hz, order, true);
}

void lag(Series& values, double rate_hz, double tau_s) {
  if (values.empty()) return;
  const double r = 2.0 * tau_s * rate_hz;
  double last = values.front();
  double out = last;
  for (double& value : values) {
    out = ((r - 1.0) * out + value + last) / (r + 1.0);
    last = value;
    value = out;
  }
}

void resonate(Series& values, double rate_hz, double natural_hz, double damping) {
  const double k = std::tan(std::numbers::pi * natural_hz / rate_hz);
  const double norm = 1.0 / (1.0 + 2.0 * damping * k + k * k);
  const double b0 = k * k * norm;
  section(values, {b0, 2.0 * b0, b0}, 2.0 * (k * k - 1.0) * norm,
          (1.0 - 2.0 * damping * k + k * k) * norm);
}

void play(Series& values, double half_width) {
  double held = values.empty() ? 0.0 : values.front();
  for (double& value : values) {
    held = std::clamp(held, value - half_width, value + half_width);
    value = held;
  }
}

double interpolate(const Series& values, double position) {
  const auto last = static_cast<double>(values.size()) - 3.0;
  const double floor = std::clamp(std::floor(position), 1.0, last);
  const double x = position - floor;
  const auto i = static_cast<std::size_t>(floor);
  return -x * (x - 1.0) * (x - 2.0) / 6.0 * values[i - 1] +
         (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0 * values[i] -
         (x + 1.0) * x * (x - 2.0) / 2.0 * values[i + 1] +
         (x + 1.0) * x * (x - 1.0) / 6.0 * values[i + 2];
}

}  // namespace stillhand::planted
