// SPDX-License-Identifier: Apache-2.0
// A loop without an end, in one thread of a program that knows nothing of it.  With LD_PRELOAD the
// thread that receives SIGRTMIN + 7 spins for ever: whatever it held it keeps, and its processor is
// busy; with SIGRTMIN + 8 it works for 80 ms.  tgkill(2) chooses the thread.  Used by inject.py and
// causes.py.
#include <csignal>
#include <ctime>

namespace {

volatile std::sig_atomic_t turns = 0;

extern "C" void spin(int /*signal*/) {
  for (;;) turns = 1;
}

extern "C" void work(int /*signal*/) {
  constexpr double kWorks_s = 0.08;
  const auto spent_s = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  for (const double from_s = spent_s(); spent_s() < from_s + kWorks_s;) turns = 1;
}

bool install(int number, void (*action)(int)) {
  struct sigaction installed{};
  installed.sa_handler = action;
  installed.sa_flags = SA_RESTART;
  return sigaction(SIGRTMIN + number, &installed, nullptr) == 0;
}

// Before main(), so that no thread exists without the action.
const bool installed = install(7, &spin) && install(8, &work);

}  // namespace
