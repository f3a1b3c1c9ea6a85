// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/recording.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/expects.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::recording {

const Column* Recording::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(columns, name, &Column::name);
  return found == columns.end() ? nullptr : &*found;
}

void estimate_timing(Recording& recording) {
  const std::vector<double>& time_s = recording.time_s;
  STILLHAND_EXPECTS(time_s.size() >= 2);
  std::vector<double> steps_s(time_s.size() - 1);
  for (std::size_t i = 0; i < steps_s.size(); ++i) steps_s[i] = time_s[i + 1] - time_s[i];

  const double median_s = signal::middle_of(steps_s);
  double sum_s = 0.0;
  std::size_t count = 0;
  for (const double step_s : steps_s) {
    if (step_s >= 0.5 * median_s && step_s <= 1.5 * median_s) {
      sum_s += step_s;
      ++count;
    }
  }
  const double period_s = sum_s / static_cast<double>(count);  // count >= 1: the median itself
  recording.rate_hz = 1.0 / period_s;
  recording.gaps.clear();
  for (std::size_t i = 0; i < steps_s.size(); ++i) {
    if (steps_s[i] > 1.5 * period_s) {
      // 2^53 bounds the count: any finite time may follow any other time.
      const double periods = std::min(std::round(steps_s[i] / period_s), 0x1p53);
      recording.gaps.push_back({i, static_cast<std::int64_t>(periods) - 1});
    }
  }
}

}  // namespace stillhand::recording
