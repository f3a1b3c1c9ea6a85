// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace stillhand::runtime {

inline constexpr std::int64_t kNsPerSecond = 1'000'000'000;

/// CLOCK_MONOTONIC [ns]: the one clock of a host's stamps and schedules.
inline std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

/// CLOCK_REALTIME [ns]: the time of day, for files and for other hosts; it may jump.
inline std::int64_t system_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

/// Sleeps until an absolute CLOCK_MONOTONIC time [ns]; goes on after signals.
inline void sleep_until_ns(std::int64_t when_ns) noexcept {
  const timespec when{when_ns / kNsPerSecond, when_ns % kNsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR) {
  }
}

}  // namespace stillhand::runtime
