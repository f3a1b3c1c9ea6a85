// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/stop.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <deque>
#include <exception>
#include <fstream>
#include <iostream>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "apps/stop/socket_owners.hpp"
#include "idl/topics.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/emergency_stop.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::stop {
namespace {

std::vector<RunningSession> asked_sessions(const StopOptions& options) {
  std::ifstream sockets("/proc/net/unix");
  std::vector<RunningSession> sessions;
  for (const RunningSession& session : running_sessions(sockets, socket_owners())) {
    if (options.domain && session.domain != *options.domain) continue;
    if (options.rig && session.rig != *options.rig) continue;
    sessions.push_back(session);
  }
  // Its lab may run on another machine.
  if (sessions.empty() && options.domain) {
    sessions.push_back({*options.domain, options.rig.value_or(1)});
  }
  return sessions;
}

std::string name_of(const RunningSession& session) {
  return fmt::format("domain {} rig {}", session.domain, session.rig);
}

runtime::Bus::Options bus_options(const StopOptions& options, const RunningSession& session) {
  runtime::Bus::Options bus;
  // It has the rights of a dashboard.
  bus.service = fmt::format("{}-stop-{}", topics::kDashboard, getpid());
  bus.rig = session.rig;
  bus.domain = session.domain;
  bus.profiles = options.profiles;
  bus.security = options.security;
  return bus;
}

// Who calls itself a rig is found within half a second; a stranger may be found first.
constexpr std::int64_t kSettles_ns = 1'000'000'000;

/// The rig that is asked, and what it answers.  Without keys a stranger may call itself the rig,
/// too: each participant of that name is asked, and each has to report zero force by itself.
class Asked {
 public:
  Asked(const StopOptions& options, const RunningSession& session)
      : name_(name_of(session)),
        bus_(bus_options(options, session)),
        request_(bus_, "stillhand stop") {
    // Events are kept for those that come later, in their order.
    bus_.subscribe<stillhand_msgs::Event>(topics::kEvent, [this](const stillhand_msgs::Event& event,
                                                                 const runtime::Arrival& arrival) {
      take(event, arrival.participant);
    });
    bus_.start();
  }

  void ask() {
    for (const runtime::ParticipantId& rig : bus_.matched_as(topics::kSessionCommand, "rig")) {
      if (!asked_.insert(rig).second) continue;
      newest_ns_ = runtime::monotonic_ns();
      if (asked_.size() == 1) first_ns_ = newest_ns_;
    }
    request_.ask();
  }
  [[nodiscard]] bool is_zero() const {
    const std::lock_guard lock(mutex_);
    return !asked_.empty() && std::ranges::includes(zero_, asked_);
  }
  [[nodiscard]] bool confirmed() const {
    return is_zero() && runtime::monotonic_ns() - newest_ns_ >= kSettles_ns;
  }
  [[nodiscard]] std::string line(std::int64_t began_ns) const {
    if (asked_.empty()) return name_ + ": no rig answers";
    if (!is_zero()) {
      return name_ + (asked_.size() == 1 ? ": the rig did not report zero force"
                                         : fmt::format(": {} participants call themselves the rig, "
                                                       "and not all report zero force",
                                                       asked_.size()));
    }
    if (!confirmed()) return name_ + ": force zero, but another rig may still turn up";
    // Not when: whether there was a force is the condition of a blinded trial.
    return fmt::format("{}: force zero ({:.0f} ms to reach the rig)", name_,
                       static_cast<double>(first_ns_ - began_ns) / 1e6);
  }

 private:
  void take(const stillhand_msgs::Event& event, const runtime::ParticipantId& from) {
    if (event.source() != "rig") return;
    const std::lock_guard lock(mutex_);
    // For good: the event of another opening may come behind it.
    if (event.code() == stillhand_msgs::CODE_EMERGENCY_STOP) stopped_.insert(from);
    if (event.kind() == stillhand_msgs::EVENT_FORCE_ZERO && stopped_.contains(from)) {
      zero_.insert(from);
    }
  }

  std::string name_;
  std::set<runtime::ParticipantId> asked_;
  std::int64_t first_ns_ = 0;   // of asked_
  std::int64_t newest_ns_ = 0;  // of asked_
  mutable std::mutex mutex_;    // guards the next two
  std::set<runtime::ParticipantId> stopped_, zero_;
  runtime::Bus bus_;  // its callbacks use what is above
  runtime::EmergencyStop request_;
};

}  // namespace

int stop_sessions(std::span<const RunningSession> sessions, const StopOptions& options,
                  const runtime::Stop& interrupted) {
  const std::int64_t began_ns = runtime::monotonic_ns();
  // On a busy machine a process without it may not even find the rig in time.  The threads of the
  // bus inherit it.
  runtime::become_real_time(!options.security.empty());
  const auto limit_ns = began_ns + static_cast<std::int64_t>(options.wait_s * 1e9);
  const auto in_time = [&] {
    return runtime::monotonic_ns() < limit_ns && !interrupted.requested();
  };
  std::deque<Asked> all;
  std::exception_ptr why;
  std::vector<std::string> failures;
  const auto ask = [&] {
    for (Asked& asked : all) asked.ask();
  };
  for (const RunningSession& session : sessions) {
    if (!in_time()) {
      failures.push_back(name_of(session) + ": no time was left to ask it");
      continue;
    }
    try {
      all.emplace_back(options, session);
    } catch (const std::exception& error) {
      why = std::current_exception();
      failures.push_back(name_of(session) + ": " + error.what());
    }
    ask();
  }
  if (all.empty() && why) std::rethrow_exception(why);
  const auto open = [&] { return !std::ranges::all_of(all, &Asked::confirmed); };
  constexpr std::int64_t kPeriod_ns = 10'000'000;
  while (open() && in_time()) {
    ask();
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPeriod_ns);
  }
  for (const Asked& asked : all) std::cout << asked.line(began_ns) << '\n';
  for (const std::string& failure : failures) runtime::remark(failure);
  const bool confirmed = !open();
  if (!confirmed && options.security.empty()) {
    runtime::remark("a session with keys hears only a stop with --security DIR");
  }
  return confirmed && all.size() == sessions.size() ? 0 : 1;
}

int run_stop(const StopOptions& options, const runtime::Stop& interrupted) {
  const std::vector<RunningSession> sessions = asked_sessions(options);
  if (!sessions.empty()) return stop_sessions(sessions, options, interrupted);
  runtime::remark("no session runs on this machine; --domain N asks one whose lab runs elsewhere");
  return 1;
}

}  // namespace stillhand::stop
