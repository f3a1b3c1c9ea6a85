// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/planted/scene.hpp"

namespace stillhand::planted {
namespace {

Series band_limited_noise(const Excitation& excitation, const Grid& grid, Draw& draw) {
  // The filters forget their start within ten periods of the lower corner.
  const auto settle = static_cast<std::size_t>(10.0 / excitation.low_hz * grid.rate_hz);
  Series out(settle + grid.size);
  for (double& value : out) value = draw.normal();
  high_pass(out, grid.rate_hz, excitation.low_hz, 4);
  low_pass(out, grid.rate_hz, excitation.high_hz, 4);
  out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(settle));
  standardise(out, excitation.rms_m_s2);
  return out;
}

Series sum_of_lines(const Excitation& excitation, const Grid& grid, Draw& draw) {
  // A whole period is computed once and repeated: samples one period apart are bit-identical.
  const auto period = static_cast<std::size_t>(std::llround(excitation.period_s * grid.rate_hz));
  Series once(period, 0.0);
  for (const double line_hz : excitation.lines_hz) {
    const double phase_rad = draw.uniform(0.0, 2.0 * std::numbers::pi);
    const double step_rad = 2.0 * std::numbers::pi * line_hz / grid.rate_hz;
    for (std::size_t i = 0; i < period; ++i) {
      once[i] += std::sin(step_rad * static_cast<double>(i) + phase_rad);
    }
  }
  standardise(once, excitation.rms_m_s2);
  Series out(grid.size);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = once[i % period];
  return out;
}

Series given(const Excitation& excitation, const Grid& grid) {
  Series out(grid.size, 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double place = 1000.0 * (grid.time_s(i) - excitation.given_start_s);
    const auto k = static_cast<std::size_t>(std::max(place, 0.0));
    if (place < 0.0 || k + 1 >= excitation.given_m_s2.size()) continue;
    const double part = place - static_cast<double>(k);
    out[i] = (1.0 - part) * excitation.given_m_s2[k] + part * excitation.given_m_s2[k + 1];
  }
  return out;
}

}  // namespace

Grid::Grid(double length_s, double sample_rate_hz) {
  per_sample =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1000.0 / sample_rate_hz)));
  rate_hz = sample_rate_hz * static_cast<double>(per_sample);
  recorded = static_cast<std::size_t>(std::llround(length_s * sample_rate_hz));
  // 10 s: a mode of 1 Hz with 3 % damping has fallen to 15 % of its start, a body to nothing.
  before = static_cast<std::size_t>(10.0 * rate_hz);
  // Clocks that run apart by up to 0.3 % look beyond the end.
  const auto after = static_cast<std::size_t>((0.5 + 0.003 * length_s) * rate_hz);
  size = before + recorded * per_sample + after;
}

Excitation draw_excitation(Draw& draw, double length_s, double rate_hz) {
  Excitation out;
  out.high_hz = draw.chance(0.5) ? 4.0 : 2.0;
  out.rms_m_s2 = draw.uniform(1.3, 1.9);
  out.starts_at_rest = draw.chance(0.4);
  out.multisine = draw.chance(0.2);
  if (!out.multisine) return out;
  // 1/3 to 1/8 of the record, 10 to 40 s, a whole number of samples.
  const double periods = std::clamp(std::round(length_s / draw.uniform(10.0, 40.0)), 2.0, 12.0);
  out.period_s = std::floor(length_s / periods * rate_hz) / rate_hz;
  for (std::int64_t k = 1; static_cast<double>(k) / out.period_s <= out.high_hz; k += 2) {
    const double line_hz = static_cast<double>(k) / out.period_s;
    if (line_hz >= out.low_hz && !draw.chance(0.25)) out.lines_hz.push_back(line_hz);
  }
  // Fewer than five lines leave the nine numbers of an order-4 body undetermined.
  if (out.lines_hz.size() < 5) {
    out.multisine = false;
    out.lines_hz.clear();
  }
  return out;
}

Series acceleration(const Excitation& excitation, const Grid& grid, Draw& draw) {
  if (!excitation.given_m_s2.empty()) return given(excitation, grid);
  Series out = excitation.multisine ? sum_of_lines(excitation, grid, draw)
                                    : band_limited_noise(excitation, grid, draw);
  if (excitation.starts_at_rest) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double x = std::clamp(grid.time_s(i), 0.0, 1.0);  // a soft start of one second
      out[i] *= 0.5 - 0.5 * std::cos(std::numbers::pi * x);
    }
  }
  return out;
}

}  // namespace stillhand::planted
