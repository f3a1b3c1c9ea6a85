// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/changed_output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

// The rows beyond a limit at one end.
struct End {
  double limit = 0.0;
  std::size_t rows = 0;
  double saved = 0.0;  // squared error, of that without a limit
};

// `z`, `y`: from the end inwards, at most half of the rows.  The limit is the mean of y beyond it.
End end_of(const std::vector<double>& z, const std::vector<double>& y, double outwards) {
  End best{outwards * std::numeric_limits<double>::infinity(), 0, 0.0};
  double sum = 0.0;
  double squares = 0.0;
  double free = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    sum += y[i];
    squares += y[i] * y[i];
    free += (y[i] - z[i]) * (y[i] - z[i]);
    const auto rows = static_cast<double>(i + 1);
    const double saved = free - (squares - sum * sum / rows);
    if (outwards * sum / rows <= outwards * z[i] && saved > best.saved)
      best = {sum / rows, i + 1, saved};
  }
  return best;
}

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

Limit limit_of(const std::vector<double>& y, const std::vector<double>& p) {
  constexpr std::size_t kMostRows = 5000;
  constexpr int kGains = 30;
  constexpr double kGainStep = 1.05;  // to 4.1: a limit that lets a quarter of the gain through
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < y.size(); i += y.size() / kMostRows + 1) order.push_back(i);
  std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
  const std::size_t n = order.size();
  Sums all;
  for (const std::size_t i : order) all.add(p[i], y[i]);
  Limit best;
  double gain = all.gain();
  for (int step = 0; step < kGains; ++step, gain *= kGainStep) {
    // The middle half of the rows lies within both limits; so does its level.
    double level = 0.0;
    for (std::size_t k = n / 4; k < n / 4 + n / 2; ++k) {
      level += (y[order[k]] - gain * p[order[k]]) / static_cast<double>(n / 2);
    }
    double error = 0.0;
    std::vector<double> z[2], of_y[2];
    for (std::size_t k = 0; k < n; ++k) {
      const double predicted = gain * p[order[k]] + level;
      error += (y[order[k]] - predicted) * (y[order[k]] - predicted);
      const std::size_t at = 2 * k < n ? 0 : 1;
      z[at].push_back(predicted);
      of_y[at].push_back(y[order[k]]);
    }
    std::ranges::reverse(z[1]);
    std::ranges::reverse(of_y[1]);
    const End low = end_of(z[0], of_y[0], -1.0);
    const End high = end_of(z[1], of_y[1], 1.0);
    const double ratio = (error - low.saved - high.saved) / all.error();
    if (ratio >= best.error_ratio) continue;
    best = {low.limit, high.limit,
            static_cast<double>(low.rows + high.rows) / static_cast<double>(n), ratio};
  }
  return best;
}

}  // namespace stillhand::identify
