// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/session_begin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace stillhand::lab {

Matching::Matching(const Roster& roster, std::string bus, double limit_s, Trouble& trouble)
    : roster_(roster), bus_(std::move(bus)), limit_s_(limit_s), trouble_(trouble) {}

std::vector<std::string> Matching::absent(const Seen& seen) const {
  std::vector<std::string> absent;
  for (const Member& member : roster_) {
    const auto found = seen.processes.find(member.name);
    if (found == seen.processes.end()) {
      absent.push_back(fmt::format("{} is not on the bus", member.name));
    } else if (!found->second.matched) {
      absent.push_back(fmt::format("{} waits for {}", member.name, found->second.missing));
    }
  }
  return absent;
}

std::string Matching::describe(const Seen& seen) const {
  std::vector<std::string> missing = absent(seen);
  for (const std::string& peer : seen.missing_peers) {
    missing.push_back("experiment waits for " + peer);
  }
  // A process that is not on the bus keeps many others waiting: the first causes are enough.
  constexpr std::size_t kMost = 10;
  const std::size_t more = missing.size() > kMost ? missing.size() - kMost : 0;
  missing.resize(missing.size() - more);
  return fmt::format("not every process was ready within {} s: {}{}", static_cast<int>(limit_s_),
                     fmt::join(missing, ", "), more > 0 ? fmt::format(", and {} more", more) : "");
}

Actions Matching::step(Seen& seen, std::int64_t now_ns) {
  if (limit_ns_ < 0) limit_ns_ = now_ns + static_cast<std::int64_t>(limit_s_ * 1e9);
  Actions actions;
  const auto missing = static_cast<double>(absent(seen).size());
  actions.progress = {"matching endpoints", 1.0 - missing / static_cast<double>(roster_.size())};
  const bool all = missing == 0.0 && seen.missing_peers.empty();
  const Wait wait = trouble_.wait(all, seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return actions;
  finish();
  complete_ = wait == Wait::kOver;
  if (!seen.duplicate_peers.empty()) {
    failure_ = fmt::format(
        "on {} there is more than one {}: another lab runs; choose another --domain or --rig", bus_,
        fmt::join(seen.duplicate_peers, ", "));
  } else if (wait == Wait::kTooLong) {
    failure_ = describe(seen);
  }
  return actions;
}

Actions ClockStart::step(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kLimit_ns = 5'000'000'000;
  if (limit_ns_ < 0) {
    limit_ns_ = now_ns + kLimit_ns;
    Actions actions;
    actions.announce = {SessionState::kRunning, std::nullopt};
    return actions;
  }
  const bool ticks = std::ranges::all_of(roster_, [&](const Member& member) {
    return !member.ticks || seen.process(member.name).tick >= 0;
  });
  const Wait wait = trouble_.wait(ticks, seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return {};
  finish();
  if (wait == Wait::kTooLong) failure_ = "the sample clock did not start within 5 s";
  return {};
}

}  // namespace stillhand::lab
