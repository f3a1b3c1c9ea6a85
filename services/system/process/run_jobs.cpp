// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/run_jobs.hpp"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace stillhand::runtime {
namespace {

class Jobs {
 public:
  Jobs(std::size_t count, unsigned workers, const std::function<void(std::size_t)>& job)
      : count_(count), job_(job), running_(workers), failed_at_(count) {}

  // What each worker does, until no job is left.
  void work() {
    while (!stop_) {
      const std::size_t index = next_++;
      if (index >= count_) break;
      std::exception_ptr caught;
      try {
        job_(index);
      } catch (...) {
        caught = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      ++done_;
      if (caught && index < failed_at_) {
        failed_at_ = index;
        failure_ = caught;
        stop_ = true;
      }
      changed_.notify_one();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_one();
  }

  // Asks on_done until the workers have ended.
  bool watch(const std::function<bool(std::size_t)>& on_done) {
    bool wanted = true;
    std::unique_lock lock(mutex_);
    while (running_ > 0) {
      changed_.wait_for(lock, std::chrono::milliseconds(100));
      const std::size_t so_far = done_;
      lock.unlock();
      if (!stop_ && !on_done(so_far)) {
        wanted = false;
        stop_ = true;
      }
      lock.lock();
    }
    return wanted;
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::size_t count_;
  const std::function<void(std::size_t)>& job_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t done_ = 0;
  unsigned running_;
  std::size_t failed_at_;
  std::exception_ptr failure_;
};

// Jobs allocate columns of some megabytes a thousand times.  By default each goes back to the
// kernel when it is freed, and the next one is filled with zeros, page by page.
void keep_freed_memory() {
  constexpr int kLargestKept_bytes = 32 << 20;  // more, glibc does not accept
  // NOLINTBEGIN(concurrency-mt-unsafe): before the jobs' threads
  static const bool kKept = mallopt(M_MMAP_THRESHOLD, kLargestKept_bytes) != 0 &&
                            mallopt(M_TRIM_THRESHOLD, 8 * kLargestKept_bytes) != 0;
  // NOLINTEND(concurrency-mt-unsafe)
  static_cast<void>(kKept);
}

}  // namespace

unsigned core_count() noexcept { return std::max(1U, std::thread::hardware_concurrency()); }

bool run_jobs(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& job,
              const std::function<bool(std::size_t)>& on_done) {
  const auto workers = static_cast<unsigned>(std::min<std::size_t>(std::max(1U, threads), count));
  if (workers == 0) return true;
  keep_freed_memory();
  Jobs jobs(count, workers, job);
  bool wanted = true;
  {
    std::vector<std::jthread> others;
    for (unsigned i = on_done ? 0 : 1; i < workers; ++i) others.emplace_back([&] { jobs.work(); });
    if (on_done) {
      wanted = jobs.watch(on_done);
    } else {
      jobs.work();
    }
  }
  jobs.rethrow();
  return wanted;
}

void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& job) {
  run_jobs(count, core_count(), job);
}

}  // namespace stillhand::runtime
