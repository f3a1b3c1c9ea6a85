// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>

namespace stillhand::runtime {

/// Turns SIGINT and SIGTERM into a flag.  Create it before any other thread starts: it blocks both
/// signals for every thread made after it and waits for them in one of its own.
class Stop {
 public:
  Stop();
  ~Stop();
  Stop(const Stop&) = delete;
  Stop& operator=(const Stop&) = delete;

  [[nodiscard]] bool requested() const noexcept {
    return requested_.load(std::memory_order_relaxed);
  }
  /// As a signal would.
  void request() noexcept;
  /// Returns once a stop was requested.
  void wait() const noexcept { requested_.wait(false); }

 private:
  std::atomic<bool> requested_{false};
  struct Watcher;
  std::unique_ptr<Watcher> watcher_;
};

}  // namespace stillhand::runtime
