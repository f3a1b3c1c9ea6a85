// SPDX-License-Identifier: Apache-2.0
#include "runtime/real_time.hpp"

#include <sched.h>
#include <sys/prctl.h>

#include <csignal>

namespace stillhand::runtime {

bool become_real_time(int priority) noexcept {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return sched_setscheduler(0, SCHED_FIFO, &parameter) == 0;
}

void become_ordinary() noexcept {
  const sched_param parameter{};
  sched_setscheduler(0, SCHED_OTHER, &parameter);
}

void end_with_parent() noexcept { prctl(PR_SET_PDEATHSIG, SIGTERM); }

}  // namespace stillhand::runtime
