// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/peak_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/motion/transform.hpp"

namespace stillhand::motion {
namespace {

using Complex = std::complex<double>;

// Clipping a little below the bound ends the rounds sooner: what the projection onto the band puts
// back then stays below it.  It affects the count of rounds only, never whether the bound holds.
constexpr double kClipShare = 0.95;

double largest(const std::vector<double>& values) noexcept {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

// What clipping changes: positive bound, any value.
double clip_change(double value, double bound) noexcept {
  return std::clamp(value, -bound, bound) - value;
}

void take_phases(MotionSpectrum& spectrum, const MotionGrid& grid, const PeakBounds& clip) {
  const std::size_t size = grid.accel_m_s2.size();
  std::vector<Complex> changes(size);
  for (std::size_t i = 0; i < size; ++i) {
    changes[i] = {clip_change(grid.accel_m_s2[i], clip.accel_m_s2),
                  clip_change(grid.position_m[i], clip.position_m)};
  }
  std::vector<Complex> lines;
  transform(size).fwd(lines, changes);
  const double per_point = 2.0 / static_cast<double>(size);
  for (std::size_t i = 0; i < spectrum.accel_m_s2.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(spectrum.first) + i;
    // The two real signals of one complex transform, separated by symmetry.
    const Complex accel = 0.5 * per_point * (lines[k] + std::conj(lines[size - k]));
    const Complex position =
        Complex{0.0, -0.5 * per_point} * (lines[k] - std::conj(lines[size - k]));
    const double w_rad_s = spectrum.rad_s(i);
    Complex& c = spectrum.accel_m_s2[i];
    const Complex moved = c + accel - w_rad_s * w_rad_s * position;
    const double magnitude = std::abs(moved);
    if (magnitude > 0.0) c = moved * (std::abs(c) / magnitude);
  }
}

}  // namespace

int limit_peaks(MotionSpectrum& spectrum, const PeakBounds& bounds) {
  const double last =
      static_cast<double>(spectrum.first) + static_cast<double>(spectrum.accel_m_s2.size()) - 1.0;
  const double margin =
      std::cos(std::numbers::pi * last / static_cast<double>(grid_size(spectrum)));
  const PeakBounds on_points{bounds.accel_m_s2 * margin, bounds.position_m * margin};
  const PeakBounds clip{on_points.accel_m_s2 * kClipShare, on_points.position_m * kClipShare};
  double best_m_s2 = 0.0;
  double best_m = 0.0;
  for (int round = 0; round <= kMaxRounds; ++round) {
    const MotionGrid grid = on_grid(spectrum);
    best_m_s2 = largest(grid.accel_m_s2);
    best_m = largest(grid.position_m);
    if (best_m_s2 <= on_points.accel_m_s2 && best_m <= on_points.position_m) return round;
    take_phases(spectrum, grid, clip);
  }
  throw ConfigError("motion.peak_m_s2",
                    std::to_string(bounds.accel_m_s2) + " m/s^2 within " +
                        std::to_string(bounds.position_m) + " m of travel",
                    "bounds that this motion can keep; its least peaks are " +
                        std::to_string(best_m_s2) + " m/s^2 and " + std::to_string(best_m) +
                        " m; lower rms_m_s2 or raise band_low_hz");
}

}  // namespace stillhand::motion
