// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/force_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillhand::dashboard {

ForceRecord::Row* ForceRecord::row_of(Tick tick) noexcept {
  if (tick < 0) return nullptr;
  if (tick <= newest_ - static_cast<Tick>(kTicks)) {  // another session
    std::ranges::fill(rows_, Row{});
    newest_ = -1;
  }
  Row& row = rows_[static_cast<std::size_t>(tick) % kTicks];
  if (row.tick != tick) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    row = {tick, kNone, kNone};
  }
  newest_ = std::max(newest_, tick);
  return &row;
}

ForceRecord::Signals ForceRecord::newest() const {
  Signals found;
  Tick before = -1;
  const Tick end = newest_ - kMargin;
  for (Tick tick = std::max<Tick>(0, newest_ - static_cast<Tick>(kTicks) + 1); tick <= end;
       ++tick) {
    const Row& row = rows_[static_cast<std::size_t>(tick) % kTicks];
    const double force_n = row.measured_n;
    const double residual_n = force_n - static_cast<double>(row.predicted_n);
    if (row.tick != tick || !std::isfinite(residual_n)) continue;
    const Tick gap = before < 0 ? 0 : tick - before - 1;
    if (gap > kBridged) found = {};
    if (!found.force_n.empty()) {
      const double force_from_n = found.force_n.back(), residual_from_n = found.residual_n.back();
      for (Tick i = 1; i <= gap; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(gap + 1);
        found.force_n.push_back(std::lerp(force_from_n, force_n, share));
        found.residual_n.push_back(std::lerp(residual_from_n, residual_n, share));
        ++found.bridged;
      }
    }
    found.force_n.push_back(force_n);
    found.residual_n.push_back(residual_n);
    before = tick;
  }
  return found;
}

}  // namespace stillhand::dashboard
