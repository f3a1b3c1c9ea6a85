// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <unsupported/Eigen/FFT>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/rotation_block.hpp"

namespace stillhand::signal {
namespace {

// Two-sided 95 % quantile of the normal distribution.
constexpr double kNormal95 = 1.959963984540054;

using Complex = std::complex<double>;

// Periodic Hann window: sums of it and of its square over the segment are exactly L/2 and 3L/8.
std::vector<double> hann(std::size_t length) {
  std::vector<double> window(length);
  for (std::size_t i = 0; i < length; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(i) / static_cast<double>(length));
  }
  return window;
}

std::vector<Complex> windowed_fft(Eigen::FFT<double>& fft, const std::vector<double>& x,
                                  std::size_t first, const std::vector<double>& window) {
  const std::size_t length = window.size();
  double mean = 0.0;
  for (std::size_t i = 0; i < length; ++i) mean += x[first + i];
  mean /= static_cast<double>(length);
  std::vector<double> segment(length);
  for (std::size_t i = 0; i < length; ++i) segment[i] = (x[first + i] - mean) * window[i];
  std::vector<Complex> lines;
  fft.fwd(lines, segment);
  lines.resize(length / 2 + 1);
  return lines;
}

void check(const std::vector<double>& x, const std::vector<double>& y, double rate_hz,
           std::size_t segment_samples) {
  if (x.size() != y.size()) {
    throw ConfigError("spectrum.y", std::to_string(y.size()) + " samples",
                      std::to_string(x.size()) + ", as many as of x");
  }
  if (segment_samples < 8 || segment_samples % 2 != 0 || segment_samples > x.size()) {
    throw ConfigError("spectrum.segment_samples", std::to_string(segment_samples),
                      "an even number from 8 to " + std::to_string(x.size()));
  }
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz)) {
    throw ConfigError("spectrum.rate_hz", std::to_string(rate_hz), "a positive finite value");
  }
}

}  // namespace

CrossSpectra cross_spectra(const std::vector<double>& x, const std::vector<double>& y,
                           double rate_hz, std::size_t segment_samples) {
  check(x, y, rate_hz, segment_samples);
  const std::size_t lines = segment_samples / 2 + 1;
  CrossSpectra out;
  out.frequency_hz.resize(lines);
  out.s_xx.assign(lines, 0.0);
  out.s_yy.assign(lines, 0.0);
  out.s_xy.assign(lines, 0.0);
  const std::vector<double> window = hann(segment_samples);
  Eigen::FFT<double> fft;
  double segments = 0.0;
  for (std::size_t first = 0; first + segment_samples <= x.size(); first += segment_samples / 2) {
    const std::vector<Complex> at_x = windowed_fft(fft, x, first, window);
    const std::vector<Complex> at_y = windowed_fft(fft, y, first, window);
    for (std::size_t k = 0; k < lines; ++k) {
      out.s_xx[k] += std::norm(at_x[k]);
      out.s_yy[k] += std::norm(at_y[k]);
      out.s_xy[k] += std::conj(at_x[k]) * at_y[k];
    }
    segments += 1.0;
  }
  const double window_power = 0.375 * static_cast<double>(segment_samples);
  for (std::size_t k = 0; k < lines; ++k) {
    const double sides = k == 0 || k + 1 == lines ? 1.0 : 2.0;
    const double scale = sides / (rate_hz * window_power * segments);
    out.frequency_hz[k] = static_cast<double>(k) * rate_hz / static_cast<double>(segment_samples);
    out.s_xx[k] *= scale;
    out.s_yy[k] *= scale;
    out.s_xy[k] *= scale;
  }
  out.independent_averages = segments / (1.0 + (1.0 - 1.0 / segments) / 18.0);
  return out;
}

std::vector<double> coherence(const CrossSpectra& spectra) {
  std::vector<double> out(spectra.s_xx.size(), 0.0);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double powers = spectra.s_xx[k] * spectra.s_yy[k];
    if (powers > 0.0) out[k] = std::min(1.0, std::norm(spectra.s_xy[k]) / powers);
  }
  return out;
}

TransferEstimate transfer_estimate(const CrossSpectra& spectra) {
  TransferEstimate out;
  out.frequency_hz = spectra.frequency_hz;
  out.coherence = coherence(spectra);
  out.independent_averages = spectra.independent_averages;
  for (std::size_t k = 0; k < out.coherence.size(); ++k) {
    const double s_xx = spectra.s_xx[k];
    out.response.push_back(s_xx > 0.0 ? spectra.s_xy[k] / s_xx : Complex(0.0));
    const double g = std::sqrt(out.coherence[k]);
    out.magnitude_ci95.push_back(g > 0.0 ? kNormal95 * std::sqrt(1.0 - out.coherence[k]) /
                                               (g * std::sqrt(2.0 * out.independent_averages))
                                         : std::numeric_limits<double>::infinity());
  }
  return out;
}

Complex line_at(const std::vector<double>& x, std::int64_t cycles_in_record) {
  const std::size_t count = x.size();
  if (cycles_in_record < 1 || 2 * static_cast<std::size_t>(cycles_in_record) >= count) {
    throw ConfigError("spectrum.cycles_in_record", std::to_string(cycles_in_record),
                      "0 < k < " + std::to_string((count + 1) / 2) + " (Nyquist)");
  }
  // Rotations within a block are tabulated; a block's own rotation is applied to its sum.
  const std::size_t block = rotation_block(count);
  const auto rotation = [&](std::size_t n) {
    const std::size_t cycles = static_cast<std::size_t>(cycles_in_record) * n % count;
    const double angle_rad = kTwoPi * (static_cast<double>(cycles) / static_cast<double>(count));
    return Complex(std::cos(angle_rad), -std::sin(angle_rad));
  };
  std::vector<Complex> within(block);
  for (std::size_t r = 0; r < block; ++r) within[r] = rotation(r);
  Complex sum = 0.0;
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t length = std::min(block, count - first);
    // Two sums in turn: the additions then don't wait for each other.
    std::array<double, 4> part{};
    for (std::size_t r = 0; r + 1 < length; r += 2) {
      part[0] += x[first + r] * within[r].real();
      part[1] += x[first + r] * within[r].imag();
      part[2] += x[first + r + 1] * within[r + 1].real();
      part[3] += x[first + r + 1] * within[r + 1].imag();
    }
    if (length % 2 == 1) {
      part[0] += x[first + length - 1] * within[length - 1].real();
      part[1] += x[first + length - 1] * within[length - 1].imag();
    }
    sum += rotation(first) * Complex(part[0] + part[2], part[1] + part[3]);
  }
  return sum * (2.0 / static_cast<double>(count));
}

}  // namespace stillhand::signal
