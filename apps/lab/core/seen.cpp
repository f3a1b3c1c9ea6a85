// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/seen.hpp"

#include <algorithm>
#include <utility>

namespace stillhand::lab {

const ProcessSeen& Seen::process(std::string_view name) const {
  static const ProcessSeen kNone;
  const auto found = processes.find(name);
  return found == processes.end() ? kNone : found->second;
}

void Seen::take(const std::string& name, ProcessSeen status) {
  ProcessSeen& known = processes[name];
  const bool said = known.armed_trial == status.armed_trial;
  status.armed_tick = said ? known.armed_tick : status.tick;
  known = std::move(status);
}

bool Seen::has(EventKind kind) const {
  return std::ranges::find(events, kind, &EventSeen::kind) != events.end();
}

Misses Seen::misses() const {
  Misses sum;
  for (const auto& [name, process] : processes) {
    sum.deadline += process.misses.deadline;
    sum.cycle += process.misses.cycle;
    sum.lost_ticks += process.misses.lost_ticks;
  }
  return sum;
}

}  // namespace stillhand::lab
