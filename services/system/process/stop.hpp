// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace stillhand::runtime {

/// Turns SIGINT and SIGTERM into a flag.  Create it before any other thread starts: it blocks both
/// signals for every thread made after it and waits for them in one of its own.  SIGCONT is
/// blocked, too.
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

/// Ends the process with status 1 when the work does not answer a stop within 0.7 s: a long step
/// has no place to look at the flag, and a person at a terminal waits no longer.  The results of
/// such work must appear at its end, as a whole.
class EndAfterStop {
 public:
  /// @param tidy  removes what is half made; runs next to the work, at the end of the process
  EndAfterStop(const Stop& stop, std::function<void()> tidy);
  ~EndAfterStop();
  EndAfterStop(const EndAfterStop&) = delete;
  EndAfterStop& operator=(const EndAfterStop&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable done_;
  bool is_done_ = false;
  std::thread watcher_;
};

}  // namespace stillhand::runtime
