// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

/// Time of day [ns] of a CLOCK_MONOTONIC time [ns], counted from what the system clock said at this
/// process's first call: somebody who sets that clock reorders nothing.
inline std::int64_t log_ns(std::int64_t monotonic) noexcept {
  static const std::int64_t offset_ns = system_ns() - monotonic_ns();
  return monotonic + offset_ns;
}

}  // namespace stillhand::runtime
