// SPDX-License-Identifier: Apache-2.0
// A clock that runs wrong, for one process: with LD_PRELOAD its monotonic and system clocks run
// faster by SKEW_PPM [ppm] and jump by SKEW_STEP_MS [ms] when the machine's monotonic clock passes
// SKEW_STEP_AT_NS [ns].  The system clock alone jumps by SKEW_SYSTEM_STEP_MS more, as a clock that
// somebody sets.  Used by machines_test.py.
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

double setting(const char* name) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing here sets a variable
  const char* value = std::getenv(name);
  return value == nullptr ? 0.0 : std::strtod(value, nullptr);
}

std::int64_t true_ns(clockid_t clock) {
  timespec time{};
  syscall(SYS_clock_gettime, clock, &time);
  return time.tv_sec * kNsPerSecond + time.tv_nsec;
}

std::int64_t wrong_by_ns(clockid_t clock) {
  static const double drift = 1e-6 * setting("SKEW_PPM");
  static const auto both_ns = static_cast<std::int64_t>(1e6 * setting("SKEW_STEP_MS"));
  static const auto system_ns = static_cast<std::int64_t>(1e6 * setting("SKEW_SYSTEM_STEP_MS"));
  static const auto step_at_ns = static_cast<std::int64_t>(setting("SKEW_STEP_AT_NS"));
  static const std::int64_t start_ns = true_ns(CLOCK_MONOTONIC);
  const std::int64_t now_ns = true_ns(CLOCK_MONOTONIC);
  const std::int64_t step_ns = both_ns + (clock == CLOCK_REALTIME ? system_ns : 0);
  return static_cast<std::int64_t>(drift * static_cast<double>(now_ns - start_ns)) +
         (now_ns >= step_at_ns ? step_ns : 0);
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  std::int64_t now_ns = true_ns(clock);
  if (clock == CLOCK_MONOTONIC || clock == CLOCK_REALTIME) now_ns += wrong_by_ns(clock);
  time->tv_sec = now_ns / kNsPerSecond;
  time->tv_nsec = now_ns % kNsPerSecond;
  return 0;
}
