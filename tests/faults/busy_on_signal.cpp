// SPDX-License-Identifier: Apache-2.0
// A loop without an end, in one thread of a program that knows nothing of it.  With LD_PRELOAD the
// thread that receives SIGRTMIN + 7 spins for ever: whatever it held it keeps, and its processor is
// busy.  tgkill(2) chooses the thread.  Used by faults.py.
#include <csignal>

namespace {

constexpr int kAfterFirst = 7;
volatile std::sig_atomic_t turns = 0;

extern "C" void spin(int /*signal*/) {
  for (;;) turns = 1;
}

// Before main(), so that no thread exists without the action.
const bool installed = [] {
  struct sigaction action{};
  action.sa_handler = spin;
  action.sa_flags = SA_RESTART;
  return sigaction(SIGRTMIN + kAfterFirst, &action, nullptr) == 0;
}();

}  // namespace
