// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/contract/tick.hpp"

namespace stillhand::dashboard {

/// The newest 20 s of the hand's force, measured and predicted, every tick of it, in whatever order
/// the two topics come.  No allocation but at the making and in newest(); one thread.
class ForceRecord {
 public:
  static constexpr std::size_t kTicks = 20'480;
  static constexpr Tick kBridged = 10;  ///< longest gap that is bridged

  void measured(Tick tick, double force_n) noexcept {
    if (Row* row = row_of(tick)) row->measured_n = static_cast<float>(force_n);
  }
  void predicted(Tick tick, double force_n) noexcept {
    if (Row* row = row_of(tick)) row->predicted_n = static_cast<float>(force_n);
  }

  /// Measured force and residual (measured - predicted), one value a tick.
  struct Signals {
    std::vector<double> force_n, residual_n;
    std::size_t bridged = 0;  ///< ticks among them on a line between their neighbours
  };
  /// Everything behind the last gap of more than kBridged ticks.
  [[nodiscard]] Signals newest() const;

 private:
  struct Row {
    Tick tick = -1;
    float measured_n, predicted_n;  // NaN: not heard
  };
  static constexpr Tick kMargin = 60;  // of the newest topic before the slowest

  Row* row_of(Tick tick) noexcept;

  std::vector<Row> rows_ = std::vector<Row>(kTicks);
  Tick newest_ = -1;
};

}  // namespace stillhand::dashboard
