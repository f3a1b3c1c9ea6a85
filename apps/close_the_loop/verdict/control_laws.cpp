// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_laws.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/cancellation/value_table.hpp"

namespace stillhand::close_the_loop {
namespace {

using cancellation::Channel;

constexpr std::size_t kTableValues = 129;
constexpr double kCells = static_cast<double>(kTableValues - 1);
// Ways to lay the table's values over a range, so that a bend falls on one of them.
constexpr int kWidths = 16;
constexpr int kShifts = 4;

cancellation::ValueMap lines(double from, double step, const std::function<double(double)>& map) {
  cancellation::ValueMap out{from, from + kCells * step, {}};
  for (std::size_t i = 0; i < kTableValues; ++i) {
    const double share = static_cast<double>(i) / kCells;
    out.values.push_back(map(out.low + share * (out.high - out.low)));
  }
  return out;
}

// What a table misses of its map between low and high.
double square_error(const cancellation::ValueMap& lines, double low, double high,
                    const std::function<double(double)>& map) {
  constexpr int kPlaces = 600;
  const cancellation::ValueTable got(lines);
  double square = 0.0;
  for (int i = 0; i <= kPlaces; ++i) {
    const double x = low + (high - low) * i / kPlaces;
    square += (got(x) - map(x)) * (got(x) - map(x));
  }
  return square;
}

}  // namespace

std::optional<Channel> channel_of(std::string_view name) {
  for (std::size_t i = 0; i < cancellation::kChannels; ++i) {
    if (cancellation::kChannelFacts[i].name == name) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

std::vector<double> factors_of(const diagnosis::Effect& effect) {
  std::vector<double> factors = effect.coefficients;
  for (double& each : factors) each *= effect.share;
  return factors;
}

cancellation::ValueMap table(double low, double high, const std::function<double(double)>& map) {
  return lines(low, (high - low) / kCells, map);
}

cancellation::ValueMap nearest_table(double low, double high,
                                     const std::function<double(double)>& map) {
  cancellation::ValueMap best;
  double least = HUGE_VAL;
  const double shortest = (high - low) / (kCells - 1.0);
  for (int wider = 0; wider < kWidths; ++wider) {
    const double step = shortest * (1.0 + static_cast<double>(wider) / kWidths);
    const double spare = kCells * step - (high - low);  // a step or more
    for (int shift = 0; shift < kShifts; ++shift) {
      const double from = low - 0.5 * (spare - step) - step * shift / kShifts;
      cancellation::ValueMap next = lines(from, step, map);
      const double error = square_error(next, low, high, map);
      if (!(error < least)) continue;
      least = error;
      best = std::move(next);
    }
  }
  return best;
}

cancellation::ValueMap held(double low, double high) {
  const double width = high - low;
  return {low - width, high + width, {low, low, high, high}};
}

cancellation::ValueMap held_table(double low, double high,
                                  const std::function<double(double)>& map) {
  // Wide enough that the outer lines are level.
  const double margin = 3.0 * (high - low) / kCells;
  return nearest_table(low - margin, high + margin,
                       [&](double x) { return map(std::clamp(x, low, high)); });
}

cancellation::DirectPath friction_path(Channel channel, double transition, double gain) {
  constexpr double kLeastTransition = 0.05;  // [rad/s] 4096 counts and 100 Hz: 0.15 rad/s a count
  const double used = std::max(transition, kLeastTransition);
  const double wide = 8.0 * used;
  return {channel, 0.0, table(-wide, wide, [&](double v) { return std::tanh(v / used); }), gain};
}

void add_waves(const diagnosis::Effect& effect, std::optional<Channel> channel, double frequency,
               double sign, cancellation::ControlModel& model) {
  const std::vector<double> factors = factors_of(effect);
  for (std::size_t h = 0; 2 * h + 1 < factors.size(); ++h) {
    model.waves.push_back({channel, static_cast<double>(h + 1) * frequency, sign * factors[2 * h],
                           sign * factors[2 * h + 1]});
  }
}

}  // namespace stillhand::close_the_loop
