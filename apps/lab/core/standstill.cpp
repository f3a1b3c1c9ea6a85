// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/standstill.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillhand::lab {
namespace {

// Ten statuses: nothing but a standstill delays a process as long.  A lost sample is a tick.
constexpr Tick kBehind_ticks = 1000;
// A rig that is silent as a whole is noticed after 3 s, with a reason of its own.
constexpr std::int64_t kClockStands_ns = 4'000'000'000;

}  // namespace

std::string Standstill::look(const Seen& seen, const Roster& roster, std::int64_t now_ns) {
  const Tick now = seen.newest_tick();
  if (now != clock_) {
    clock_ = now;
    clock_since_ns_ = now_ns;
  }
  if (now_ns - clock_since_ns_ > kClockStands_ns) {
    return fmt::format("{} stands still: no tick for {} s", kSampleClock,
                       kClockStands_ns / 1'000'000'000);
  }
  const auto stands = [&](const Member& member) {
    return now - seen.process(member.name).tick > kBehind_ticks;
  };
  const auto first = std::ranges::find_if(roster, stands);
  if (first == roster.end()) return "";
  const Tick newest = seen.process(first->name).tick;
  if (newest < 0) return fmt::format("{} has handled no tick, the rig's is {}", first->name, now);
  return fmt::format("{} stands still: its newest tick is {}, the rig's {}", first->name, newest,
                     now);
}

}  // namespace stillhand::lab
