// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/clock_line.hpp"

#include <algorithm>

namespace stillhand::session {

ClockLine::ClockLine(const std::vector<stillhand_msgs::ClockOffset>& offsets,
                     std::string_view service) {
  for (const stillhand_msgs::ClockOffset& offset : offsets) {
    if (service != offset.service().c_str()) continue;
    known_.push_back({offset.stamp_ns() + offset.offset_ns(), offset.offset_ns()});
    uncertainty_ns_ = std::max(uncertainty_ns_, offset.uncertainty_ns());
  }
  std::ranges::stable_sort(known_, {}, &Known::from_ns);
}

std::int64_t ClockLine::on_experiments_clock(std::int64_t stamp_ns) const {
  if (known_.empty()) return stamp_ns;
  // Before the first offset was known, the first one holds.
  const auto after = std::ranges::upper_bound(known_, stamp_ns, {}, &Known::from_ns);
  return stamp_ns - (after == known_.begin() ? *after : *(after - 1)).offset_ns;
}

}  // namespace stillhand::session
