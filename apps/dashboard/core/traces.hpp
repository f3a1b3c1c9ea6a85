// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "services/core/contract/tick.hpp"

namespace stillhand::dashboard {

/// Signals of a trace, in the order of a row.
enum class Signal : std::size_t {
  kAcceleration,
  kForce,
  kPredictedForce,
  kMotorForce,
  kTarget,
  kCursor
};
inline constexpr std::size_t kSignals = 6;

/// The newest ten seconds of six signals at every 20th tick: a picture, not a measurement (signals
/// above 25 Hz are aliased).  Topics fill a row in any order.  Pure, no allocation but in
/// rows(); one thread.
class Traces {
 public:
  struct Row {
    Tick tick = -1;
    std::array<double, kSignals> values{};  ///< NaN: not heard
  };
  static constexpr Tick kEvery = 20;
  static constexpr std::size_t kRows = 500;

  void put(Tick tick, Signal signal, double value) noexcept {
    if (tick < 0 || tick % kEvery != 0) return;
    if (tick <= newest_ - static_cast<Tick>(kRows) * kEvery) *this = {};  // another session
    Row& row = rows_[static_cast<std::size_t>(tick / kEvery) % kRows];
    if (row.tick != tick) {
      row.tick = tick;
      row.values.fill(std::numeric_limits<double>::quiet_NaN());
    }
    row.values[static_cast<std::size_t>(signal)] = value;
    newest_ = std::max(newest_, tick);
  }

  /// Rows behind `after` that every topic had the time to fill, by tick.
  [[nodiscard]] std::vector<Row> rows(Tick after = -1) const {
    std::vector<Row> found;
    const Tick oldest = newest_ - static_cast<Tick>(kRows) * kEvery;
    for (const Row& row : rows_) {
      if (row.tick > std::max(after, oldest) && row.tick <= newest_ - kMargin) found.push_back(row);
    }
    std::ranges::sort(found, {}, &Row::tick);
    return found;
  }

 private:
  static constexpr Tick kMargin = 60;  // of the newest topic before the slowest

  std::array<Row, kRows> rows_{};
  Tick newest_ = -1;
};

}  // namespace stillhand::dashboard
