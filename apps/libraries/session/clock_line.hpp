// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "idl/clock.h"

namespace stillhand::session {

/// Offset of a process's monotonic clock from the experiment's, as it was known at each moment of a
/// recording (services/core/clock).
class ClockLine {
 public:
  /// @param offsets  of every process, in the order they were published
  ClockLine(const std::vector<stillhand_msgs::ClockOffset>& offsets, std::string_view service);

  /// Converts a stamp [ns] of the process to the experiment's clock; unchanged without an offset.
  [[nodiscard]] std::int64_t on_experiments_clock(std::int64_t stamp_ns) const;
  /// Half width [ns] of the worst offset.
  [[nodiscard]] double uncertainty_ns() const noexcept { return uncertainty_ns_; }

 private:
  struct Known {
    std::int64_t from_ns;  ///< on the process's own clock
    std::int64_t offset_ns;
  };
  std::vector<Known> known_;  ///< in time
  double uncertainty_ns_ = 0.0;
};

}  // namespace stillhand::session
