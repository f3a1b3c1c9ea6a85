// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/changed_output.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::identify {
namespace {

// Of rows: what a least-squares line y = gain p + level needs.
struct Sums {
  double n = 0.0, p = 0.0, y = 0.0, pp = 0.0, py = 0.0, yy = 0.0;

  void add(double of_p, double of_y) {
    n += 1.0;
    p += of_p;
    y += of_y;
    pp += of_p * of_p;
    py += of_p * of_y;
    yy += of_y * of_y;
  }
  [[nodiscard]] Sums without(const Sums& o) const {
    return {n - o.n, p - o.p, y - o.y, pp - o.pp, py - o.py, yy - o.yy};
  }
  [[nodiscard]] double spread() const { return pp - p * p / n; }
  [[nodiscard]] double gain() const { return (py - p * y / n) / spread(); }
  [[nodiscard]] double level() const { return level_at(gain()); }
  [[nodiscard]] double level_at(double g) const { return (y - g * p) / n; }
  [[nodiscard]] double error() const { return error_at_gain(gain()); }
  // Of a level of its own.
  [[nodiscard]] double error_at_gain(double g) const {
    return yy - y * y / n - 2.0 * g * (py - p * y / n) + g * g * spread();
  }
  // Of a gain of its own.
  [[nodiscard]] double gain_at_level(double m) const { return (py - m * p) / pp; }
  [[nodiscard]] double error_at_level(double m) const {
    return yy - 2.0 * m * y + n * m * m - gain_at_level(m) * (py - m * p);
  }
};

}  // namespace

Change change_of(const std::vector<double>& y, const std::vector<double>& p) {
  constexpr std::size_t kGrid = 100;
  std::vector<Sums> until{{}};
  for (std::size_t i = 0; i < y.size(); ++i) {
    until.push_back(until.back());
    until.back().add(p[i], y[i]);
  }
  const Sums& all = until.back();
  const double gain = all.gain();
  const double level = all.level();
  Change best;
  const auto look_at = [&](std::size_t first, std::size_t end) {
    const Sums inside = until[end].without(until[first]);
    const Sums outside = all.without(inside);
    // Where it hardly moves, it shows no gain.
    if (20.0 * std::min(inside.n, outside.n) < all.n ||
        100.0 * std::min(inside.spread(), outside.spread()) < all.spread()) {
      return;
    }
    const double of_level = inside.error_at_gain(gain) + outside.error_at_gain(gain);
    const double of_gain = inside.error_at_level(level) + outside.error_at_level(level);
    const double ratio = std::min(of_level, of_gain) / all.error();
    if (!(ratio < best.error_ratio)) return;
    best = {first,
            end,
            of_level < of_gain,
            inside.gain_at_level(level) / outside.gain_at_level(level),
            inside.level_at(gain) - outside.level_at(gain),
            ratio};
  };
  const auto row = [&](std::size_t k) { return k * y.size() / kGrid; };
  for (std::size_t k = 1; k < kGrid; ++k) {
    for (std::size_t m = k + 1; m <= kGrid; ++m) look_at(row(k), row(m));
  }
  const std::size_t near = y.size() / kGrid + 1;
  for (int round = 0; round < 2; ++round) {
    const Change from = best;
    for (std::size_t i = from.first - std::min(near, from.first); i < from.first + near; ++i) {
      if (i < from.end) look_at(i, from.end);
    }
    if (from.end == y.size()) continue;
    const std::size_t first = best.first;
    for (std::size_t i = from.end - near; i <= std::min(from.end + near, y.size()); ++i) {
      if (i > first) look_at(first, i);
    }
  }
  return best;
}

}  // namespace stillhand::identify
