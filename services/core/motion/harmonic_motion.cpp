// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/harmonic_motion.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/expects.hpp"
#include "services/core/motion/transform.hpp"

namespace stillhand::motion {
namespace {

using Complex = std::complex<double>;

constexpr double kPointsPerCycle = 25.0;

bool smooth(std::size_t n) noexcept {
  for (const std::size_t factor : {2u, 3u, 5u}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

// Two real signals with spectra p and q by one complex transform: p + j q.
std::vector<Complex> pair_on_grid(const std::vector<Complex>& p, const std::vector<Complex>& q,
                                  std::int64_t first, std::size_t size) {
  const Complex j{0.0, 1.0};
  std::vector<Complex> spectrum(size, Complex{});
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(first) + i;
    spectrum[k] = 0.5 * (p[i] + j * q[i]);
    spectrum[size - k] = 0.5 * (std::conj(p[i]) + j * std::conj(q[i]));
  }
  std::vector<Complex> grid;
  transform(size).inv(grid, spectrum);
  return grid;
}

// The spectrum differentiated `times` times; negative integrates.
std::vector<Complex> derivative(const MotionSpectrum& spectrum, int times) {
  std::vector<Complex> out(spectrum.accel_m_s2);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Complex jw{0.0, spectrum.rad_s(i)};
    for (int n = 0; n < times; ++n) out[i] *= jw;
    for (int n = 0; n > times; --n) out[i] /= jw;
  }
  return out;
}

// Value and three derivatives at one grid point, in units of the cell: h^n d^n x / dt^n [m].
using Point = std::array<double, 4>;

std::array<double, 8> cell_between(const Point& a, const Point& b) noexcept {
  const double c0 = a[0];
  const double c1 = a[1];
  const double c2 = a[2] / 2.0;
  const double c3 = a[3] / 6.0;
  const double d0 = b[0] - (c0 + c1 + c2 + c3);
  const double d1 = b[1] - (c1 + 2.0 * c2 + 3.0 * c3);
  const double d2 = b[2] - (2.0 * c2 + 6.0 * c3);
  const double d3 = b[3] - 6.0 * c3;
  return {c0,
          c1,
          c2,
          c3,
          35.0 * d0 - 15.0 * d1 + 2.5 * d2 - d3 / 6.0,
          -84.0 * d0 + 39.0 * d1 - 7.0 * d2 + 0.5 * d3,
          70.0 * d0 - 34.0 * d1 + 6.5 * d2 - 0.5 * d3,
          -20.0 * d0 + 10.0 * d1 - 2.0 * d2 + d3 / 6.0};
}

}  // namespace

double MotionSpectrum::rms_m_s2() const noexcept {
  double sum = 0.0;
  for (const Complex& c : accel_m_s2) sum += 0.5 * std::norm(c);
  return std::sqrt(sum);
}

void MotionSpectrum::scale(double factor) noexcept {
  for (Complex& c : accel_m_s2) c *= factor;
}

std::size_t grid_size(const MotionSpectrum& spectrum) {
  STILLHAND_EXPECTS(spectrum.first >= 1 && !spectrum.accel_m_s2.empty());
  const auto last =
      static_cast<double>(spectrum.first) + static_cast<double>(spectrum.accel_m_s2.size()) - 1.0;
  auto size = static_cast<std::size_t>(std::ceil(kPointsPerCycle * last));
  while (!smooth(size)) ++size;
  return size;
}

MotionGrid on_grid(const MotionSpectrum& spectrum) {
  const std::vector<Complex> grid = pair_on_grid(spectrum.accel_m_s2, derivative(spectrum, -2),
                                                 spectrum.first, grid_size(spectrum));
  MotionGrid out;
  out.accel_m_s2.reserve(grid.size());
  out.position_m.reserve(grid.size());
  for (const Complex& z : grid) {
    out.accel_m_s2.push_back(z.real());
    out.position_m.push_back(z.imag());
  }
  return out;
}

HarmonicMotion::HarmonicMotion(const MotionSpectrum& spectrum) {
  const std::size_t size = grid_size(spectrum);
  cells_per_s_ = static_cast<double>(size) / spectrum.period_s;
  cells_per_tick_ = cells_per_s_ * kControlPeriod_s;
  const std::vector<Complex> slow =
      pair_on_grid(derivative(spectrum, -2), derivative(spectrum, -1), spectrum.first, size);
  const std::vector<Complex> fast =
      pair_on_grid(spectrum.accel_m_s2, derivative(spectrum, 1), spectrum.first, size);
  const double h_s = 1.0 / cells_per_s_;
  const auto point = [&](std::size_t i) -> Point {
    return {slow[i].real(), h_s * slow[i].imag(), h_s * h_s * fast[i].real(),
            h_s * h_s * h_s * fast[i].imag()};
  };
  cells_.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    cells_.push_back(cell_between(point(i), point(i + 1 == size ? 0 : i + 1)));
  }
}

signal::MotionSample HarmonicMotion::at(Tick n) const noexcept {
  const double along = static_cast<double>(n) * cells_per_tick_;
  const double whole = std::floor(along);
  const double u = along - whole;
  const auto count = static_cast<std::int64_t>(cells_.size());
  const std::int64_t index = (static_cast<std::int64_t>(whole) % count + count) % count;
  const auto& c = cells_[static_cast<std::size_t>(index)];
  double x = c[7];
  double v = 7.0 * c[7];
  double a = 42.0 * c[7];
  for (int i = 6; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    x = x * u + c[k];
    if (i >= 1) v = v * u + i * c[k];
    if (i >= 2) a = a * u + i * (i - 1) * c[k];
  }
  return {a * cells_per_s_ * cells_per_s_, v * cells_per_s_, x};
}

}  // namespace stillhand::motion
