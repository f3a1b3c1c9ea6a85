// SPDX-License-Identifier: Apache-2.0
#include "runtime/real_time.hpp"

#include <sched.h>
#include <sys/prctl.h>

#include <csignal>

namespace stillhand::runtime {

namespace {

bool take_priority(int priority) noexcept {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
}

}  // namespace

bool become_real_time() noexcept {
  constexpr int kControlPriority = 40;  // below the kernel's threaded interrupts at 50
  return take_priority(kControlPriority);
}

void become_background() noexcept {
  constexpr int kBackgroundPriority = 10;
  if (sched_getscheduler(0) == SCHED_FIFO) take_priority(kBackgroundPriority);
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

void end_with_parent() noexcept { prctl(PR_SET_PDEATHSIG, SIGTERM); }

}  // namespace stillhand::runtime
