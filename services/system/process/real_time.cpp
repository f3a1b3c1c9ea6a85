// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/real_time.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

namespace stillhand::runtime {

namespace {

bool take_priority(int policy, int priority) noexcept {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return sched_setscheduler(0, policy, &parameter) == 0;
}

}  // namespace

int priority_of(std::string_view service) noexcept {
  const bool in_loop = service == "rig" || service == "sensing" || service == "cancellation";
  return in_loop ? kControlPriority : kListenerPriority;
}

bool become_real_time(bool secured, int priority) noexcept {
  return take_priority(secured ? SCHED_RR : SCHED_FIFO, priority);
}

bool lock_memory() noexcept {
  rlimit limit{};
  const bool limited = getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_cur < kMemoryToLock;
  if (limited && geteuid() != 0) return false;  // for root, CAP_IPC_LOCK, it does not count
  // As they are touched: the stacks of Fast DDS's threads alone are some 50 MB, mostly unused.
  return mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
}

void become_background(Locks locks) noexcept {
  constexpr int kBackgroundPriority = 10;
  const int policy = sched_getscheduler(0);
  if (policy == SCHED_FIFO || (policy == SCHED_RR && locks == Locks::kOwn)) {
    take_priority(policy, kBackgroundPriority);
  }
}

OrdinaryWhile::OrdinaryWhile() noexcept : policy_(sched_getscheduler(0)) {
  sched_param parameter{};
  sched_getparam(0, &parameter);
  priority_ = parameter.sched_priority;
  parameter.sched_priority = 0;
  sched_setscheduler(0, SCHED_OTHER, &parameter);
}

OrdinaryWhile::~OrdinaryWhile() {
  sched_param parameter{};
  parameter.sched_priority = priority_;
  sched_setscheduler(0, policy_, &parameter);
}

void end_with_parent(pid_t parent) noexcept {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) kill(getpid(), SIGTERM);
}

}  // namespace stillhand::runtime
