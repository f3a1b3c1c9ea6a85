// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/line_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kBinsPerShortestPeriod = 16.0;
constexpr double kStepsPerLine = 4.0;  // of 1/range
constexpr std::size_t kMostBins = 1U << 22;
constexpr std::size_t kSurroundings = 60;  // lines on each side

double median_around(const std::vector<double>& power, std::size_t at) {
  const std::size_t first = at > kSurroundings ? at - kSurroundings : 0;
  const std::size_t end = std::min(power.size(), at + kSurroundings + 1);
  return signal::middle_of({power.begin() + static_cast<std::ptrdiff_t>(first),
                            power.begin() + static_cast<std::ptrdiff_t>(end)});
}

}  // namespace

std::vector<Line> strongest_lines(const std::vector<double>& axis,
                                  const std::vector<double>& residual, double lowest,
                                  double highest, std::size_t count) {
  const auto [low, high] = std::ranges::minmax(axis);
  const double range = high - low;
  if (!(range > 0.0) || !(highest > lowest)) return {};
  const double wanted = range * kStepsPerLine * highest * kBinsPerShortestPeriod;
  const std::size_t bins =
      std::bit_ceil(std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 256, kMostBins));
  // The bins span kStepsPerLine ranges, the rest of them empty: the spectrum is that much finer.
  const double width = kStepsPerLine * range / static_cast<double>(bins - 1);
  std::vector<double> gathered(bins, 0.0);
  for (std::size_t n = 0; n < axis.size(); ++n) {
    gathered[static_cast<std::size_t>(std::lround((axis[n] - low) / width))] += residual[n];
  }
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  transform.fwd(spectrum, gathered);
  const double step = 1.0 / (static_cast<double>(bins) * width);
  const auto first = static_cast<std::size_t>(std::ceil(lowest / step));
  const auto last =
      std::min(spectrum.size() - 1, static_cast<std::size_t>(std::floor(highest / step)));
  if (first + 3 > last) return {};
  std::vector<double> power(last - first + 1);
  for (std::size_t i = 0; i < power.size(); ++i) {
    power[i] = std::norm(spectrum[first + i]) / static_cast<double>(axis.size());
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 1; i + 1 < power.size(); ++i) {
    if (power[i] >= power[i - 1] && power[i] > power[i + 1]) order.push_back(i);
  }
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
  std::vector<Line> lines;
  for (const std::size_t i : order) {
    if (lines.size() == count) break;
    const double frequency = static_cast<double>(first + i) * step;
    const bool side_lobe = std::ranges::any_of(lines, [&](const Line& line) {
      return std::abs(line.frequency - frequency) < 3.0 / range;
    });
    if (side_lobe) continue;
    lines.push_back({frequency, power[i], power[i] / std::max(median_around(power, i), 1e-300)});
  }
  return lines;
}

}  // namespace stillhand::diagnosis
