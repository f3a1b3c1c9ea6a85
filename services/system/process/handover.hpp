// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>
#include <utility>

#include "services/system/process/real_time.hpp"
#include "services/system/process/wake_up.hpp"

namespace stillhand::runtime {

/// Makes something large in a thread of its own and hands it to the control path: a trial's motion,
/// a trial's target, a model's filter.  prepare() from any thread, current() from one.  Neither
/// takes a lock or frees memory, current() does not allocate either: both may run in the thread
/// that receives samples, and the worker may be preempted anywhere.
template <typename T>
class Handover {
 public:
  using Make = std::function<std::unique_ptr<T>()>;

  Handover() : worker_([this](const std::stop_token& stop) { work(stop); }) {}
  ~Handover() {
    worker_.request_stop();
    wake_.post();
    worker_.join();
    free_all(requests_.load());
    delete fresh_.load();
    delete spent_.load();
    delete current_;
  }
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;

  /// Asks for a new one; a request not yet begun is replaced.  `make` may return nullptr: no
  /// change.
  void prepare(Make make) {
    // The worker takes and frees all that were pushed; nobody takes a single one, so no request is
    // freed while another thread looks at it.
    auto* const request = new Request{std::move(make), requests_.load(std::memory_order_relaxed)};
    while (!requests_.compare_exchange_weak(request->before, request, std::memory_order_release,
                                            std::memory_order_relaxed)) {
    }
    wake_.post();
  }

  /// Control path: the newest finished one, or nullptr before the first.
  T* current() noexcept {
    // One is kept back until the worker has freed the one before: no deallocation here.
    if (spent_.load(std::memory_order_acquire) == nullptr) {
      if (T* fresh = fresh_.exchange(nullptr, std::memory_order_acq_rel)) {
        spent_.store(current_, std::memory_order_release);
        if (current_ != nullptr) wake_.post();  // freed at once: it would keep the next one away
        current_ = fresh;
      }
    }
    return current_;
  }

 private:
  struct Request {
    Make make;
    Request* before;
  };

  void work(const std::stop_token& stop) {
    become_background();
    while (true) {
      wake_.wait([&] {
        return stop.stop_requested() || requests_.load() != nullptr || spent_.load() != nullptr;
      });
      if (stop.stop_requested()) return;
      delete spent_.exchange(nullptr, std::memory_order_acq_rel);
      const std::unique_ptr<Request> newest(requests_.exchange(nullptr, std::memory_order_acquire));
      if (newest == nullptr) continue;
      free_all(newest->before);
      if (std::unique_ptr<T> made = make_ordinarily(newest->make)) {
        delete fresh_.exchange(made.release(), std::memory_order_acq_rel);
      }
    }
  }

  static void free_all(Request* newest) {
    while (newest != nullptr) delete std::exchange(newest, newest->before);
  }

  static std::unique_ptr<T> make_ordinarily(const Make& make) {
    const OrdinaryWhile ordinary;
    return make();
  }

  WakeUp wake_;
  std::atomic<Request*> requests_{nullptr};  ///< the newest; each points to the one before
  std::atomic<T*> fresh_{nullptr};
  std::atomic<T*> spent_{nullptr};
  T* current_ = nullptr;
  std::jthread worker_;  // last: starts when the rest is there
};

}  // namespace stillhand::runtime
