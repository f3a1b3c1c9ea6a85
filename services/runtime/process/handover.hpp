// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "services/runtime/process/real_time.hpp"

namespace stillhand::runtime {

/// Makes something large in a thread of its own and hands it to the control path, which takes it
/// without lock or allocation: a trial's motion, a trial's target, a model's filter.
/// prepare() from one thread, current() from one other.
template <typename T>
class Handover {
 public:
  using Make = std::function<std::unique_ptr<T>()>;

  Handover() : worker_([this](const std::stop_token& stop) { work(stop); }) {}
  ~Handover() {
    worker_.request_stop();
    worker_.join();
    delete fresh_.load();
    delete spent_.load();
    delete current_;
  }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  /// Asks for a new one; a request not yet begun is replaced.  `make` may return nullptr: no
  /// change.
  void prepare(Make make) {
    {
      const std::lock_guard lock(mutex_);
      pending_ = std::move(make);
    }
    wake_.notify_all();
  }

  /// Control path: the newest finished one, or nullptr before the first.
  T* current() noexcept {
    // One is kept back until the worker has freed the one before: no deallocation here.
    if (spent_.load(std::memory_order_acquire) == nullptr) {
      if (T* fresh = fresh_.exchange(nullptr, std::memory_order_acq_rel)) {
        spent_.store(current_, std::memory_order_release);
        current_ = fresh;
      }
    }
    return current_;
  }

 private:
  void work(const std::stop_token& stop) {
    become_background();
    while (!stop.stop_requested()) {
      Make make;
      {
        std::unique_lock lock(mutex_);
        // With the token: a stop between the look at `pending_` and the sleep wakes it, too.
        wake_.wait(lock, stop, [this] { return static_cast<bool>(pending_); });
        make = std::exchange(pending_, nullptr);
      }
      delete spent_.exchange(nullptr, std::memory_order_acq_rel);
      if (!make) continue;
      if (std::unique_ptr<T> made = make_ordinarily(make)) {
        delete fresh_.exchange(made.release(), std::memory_order_acq_rel);
      }
    }
  }

  static std::unique_ptr<T> make_ordinarily(const Make& make) {
    const OrdinaryWhile ordinary;
    return make();
  }

  std::mutex mutex_;
  std::condition_variable_any wake_;
  Make pending_;
  std::atomic<T*> fresh_{nullptr};
  std::atomic<T*> spent_{nullptr};
  T* current_ = nullptr;
  std::jthread worker_;  // last: starts when the rest is there
};

}  // namespace stillhand::runtime
