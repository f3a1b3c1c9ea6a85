// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/stop.hpp"

#include <pthread.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <utility>

#include "services/system/process/remark.hpp"

namespace stillhand::runtime {
namespace {

// Wakes the watcher at destruction; never sent from outside.
constexpr int kWakeSignal = SIGUSR2;

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  // The terminal was closed; a process started by nohup continues.
  struct sigaction hangup{};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
    sigaddset(&set, SIGHUP);
  }
  sigaddset(&set, kWakeSignal);
  return set;
}

}  // namespace

struct Stop::Watcher {
  std::thread thread;
};

Stop::Stop() : watcher_(std::make_unique<Watcher>()) {
  const sigset_t set = watched_signals();
  sigset_t blocked = set;
  sigaddset(&blocked, SIGCONT);  // which continues the process all the same: StallWatch counts it
  pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
  // A pipe whose reader left shows as a failed write, not as a signal.
  std::signal(SIGPIPE, SIG_IGN);
  watcher_->thread = std::thread([this, set] {
    for (;;) {
      int signal = 0;
      if (sigwait(&set, &signal) != 0 || signal == kWakeSignal) return;
      request();
    }
  });
}

Stop::~Stop() {
  pthread_kill(watcher_->thread.native_handle(), kWakeSignal);
  watcher_->thread.join();
}

void Stop::request() noexcept {
  requested_.store(true);
  requested_.notify_all();
}

EndAfterStop::EndAfterStop(const Stop& stop, std::function<void()> tidy)
    : watcher_([this, &stop, tidy = std::move(tidy)] {
        using std::chrono::milliseconds;
        std::unique_lock lock(mutex_);
        while (
            !done_.wait_for(lock, milliseconds(50), [&] { return is_done_ || stop.requested(); })) {
        }
        if (done_.wait_for(lock, milliseconds(650), [&] { return is_done_; })) return;
        remark("interrupted");
        tidy();
        std::_Exit(1);
      }) {}

EndAfterStop::~EndAfterStop() {
  {
    const std::lock_guard lock(mutex_);
    is_done_ = true;
  }
  done_.notify_all();
  watcher_.join();
}

}  // namespace stillhand::runtime
