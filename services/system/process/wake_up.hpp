// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <semaphore.h>

#include <cerrno>
#include <cstdint>

#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

/// Wakes the one thread that waits for something another thread has stored.  A POSIX semaphore:
/// post() is a counter and, only while somebody sleeps, one system call; neither side takes a lock
/// or allocates.  The waiting thread does not use the processor.
class WakeUp {
 public:
  WakeUp() noexcept { sem_init(&semaphore_, 0, 0); }
  ~WakeUp() { sem_destroy(&semaphore_); }
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  void post() noexcept { sem_post(&semaphore_); }

  /// Waits until `is_there()`.  A post() from before the call only makes it look once more.
  template <typename IsThere>
  void wait(IsThere is_there) noexcept {
    while (!is_there()) sem_wait(&semaphore_);
  }

  /// Waits until `is_there()` or until `until_ns` of CLOCK_MONOTONIC, whatever is first.  A post()
  /// from before the call only makes it look once more.
  /// @returns is_there()
  template <typename IsThere>
  bool wait_until_ns(std::int64_t until_ns, IsThere is_there) noexcept {
    const timespec until{until_ns / kNsPerSecond, until_ns % kNsPerSecond};
    while (!is_there()) {
      // A sender without a pause keeps the counter above zero: the clock ends that too.
      if (monotonic_ns() >= until_ns) return false;
      if (sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) != 0 && errno != EINTR) {
        return is_there();
      }
    }
    return true;
  }

 private:
  sem_t semaphore_;
};

}  // namespace stillhand::runtime
