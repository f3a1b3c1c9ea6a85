// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/trial_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/lab/core/prompt.hpp"

namespace stillhand::lab {
namespace {

constexpr std::int64_t kArmLimit_ns = 10'000'000'000;
constexpr std::int64_t kNsPerTick = 1'000'000;
constexpr std::int64_t kForEver_ns = std::numeric_limits<std::int64_t>::max();

}  // namespace

TrialRun::TrialRun(const Trial& planned, const Roster& roster, Trouble& trouble)
    : roster_(roster), trouble_(trouble), limit_ns_(kForEver_ns) {
  result_.trial = planned;
}

Actions TrialRun::step(Seen& seen, std::int64_t now_ns) {
  Actions actions;
  while (!over() && advance(seen, now_ns, actions)) {
  }
  return actions;
}

bool TrialRun::advance(Seen& seen, std::int64_t now_ns, Actions& actions) {
  switch (at_) {
    case At::kPaused:
      return await_start(seen, now_ns, actions);
    case At::kArming:
      return await_armed(seen, now_ns, actions);
    case At::kRunning:
      return follow(seen, now_ns, actions);
    case At::kForceZero:
      return await_force_zero(seen, now_ns, actions);
    case At::kAfterwards:
      return await_afterwards(seen, now_ns);
    case At::kDeath:
      return await_death(seen, now_ns);
  }
  return false;
}

bool TrialRun::move_on(At at, std::int64_t limit_ns) {
  at_ = at;
  limit_ns_ = limit_ns;
  return true;
}

Tick TrialRun::first_tick() const { return result_.trial.start_tick - result_.trial.ramp_ticks; }

Tick TrialRun::last_tick() const {
  const Trial& trial = result_.trial;
  return trial.start_tick + trial.duration_ticks + trial.ramp_ticks;
}

bool TrialRun::await_start(Seen& seen, std::int64_t now_ns, Actions& actions) {
  const bool start = !seen.requests.paused() && seen.requests.emergency().empty();
  const Wait wait = trouble_.wait(start, seen, limit_ns_, now_ns);
  if (wait == Wait::kOver) {
    begin(seen, now_ns, actions);
    return true;
  }
  if (!start) {
    if (!announced_pause_) actions.announce = {SessionState::kPaused, std::nullopt};
    announced_pause_ = true;
    actions.progress = {
        fmt::format("paused before trial {}, for a start from the dashboard", result_.trial.number),
        0.0};
  }
  if (wait == Wait::kGoesOn) return false;
  // Nothing of it ran: the trial has no events and no misses.
  result_.aborted = trouble_.why_stopped(seen, "");
  finish();
  return true;
}

// A request from here on is a request to this trial.
void TrialRun::begin(Seen& seen, std::int64_t now_ns, Actions& actions) {
  seen.events.clear();
  seen.requests.begin_trial();
  seen.trial_runs = true;
  before_ = seen.misses();
  Trial& trial = result_.trial;
  trial.start_tick = seen.newest_tick() + ticks_in(kTrialLead_s) + trial.ramp_ticks;
  actions.assign = trial;
  actions.announce = {SessionState::kRunning, trial};
  move_on(At::kArming, now_ns + kArmLimit_ns);
}

bool TrialRun::armed(const Seen& seen, const Member& member) const {
  return !member.prepares || seen.process(member.name).armed_trial == result_.trial.number;
}

// The assignment stays.
void TrialRun::postpone(const Seen& seen, Actions& actions) {
  Trial& trial = result_.trial;
  trial.start_tick = seen.newest_tick() + ticks_in(kTrialLead_s) + trial.ramp_ticks;
  actions.announce = {SessionState::kRunning, trial};
  // Not who: it may be the one that has more to prepare in some conditions.
  actions.note = fmt::format("trial {} begins later: not everything is prepared yet", trial.number);
}

// Empty: nobody.  The conductor was held up, or the announcement.
std::string TrialRun::why_late(const Seen& seen) const {
  for (const Member& member : roster_) {
    if (!member.prepares || seen.process(member.name).armed_tick < first_tick()) continue;
    return fmt::format("{} was prepared at tick {}, after the trial began at {}", member.name,
                       seen.process(member.name).armed_tick, first_tick());
  }
  return {};
}

bool TrialRun::await_armed(Seen& seen, std::int64_t now_ns, Actions& actions) {
  // A status is up to 100 ticks old when it comes, and the announcement has to arrive.
  constexpr Tick kNotice_ticks = 300;
  const bool all =
      std::ranges::all_of(roster_, [&](const Member& member) { return armed(seen, member); });
  // The rig names what is missing; who waits for that process is not the reason.
  if (seen.has(EventKind::kInterlockOpened)) {
    announce_idle(actions);
    return look_for_death(seen, now_ns);
  }
  // The seat may be on its way to its place.
  if (!seen.requests.trial_stopped().empty()) {
    announce_idle(actions);
    return end(seen);
  }
  // Who lost sight of the session in a pause needs the next ticks to come back.
  const std::string stands = standstill_.look(seen, roster_, now_ns);
  switch (trouble_.wait(all && stands.empty(), seen, limit_ns_, now_ns)) {
    case Wait::kGoesOn:
      if (!all && seen.newest_tick() + kNotice_ticks >= first_tick()) {
        postpone(seen, actions);
      }
      return false;
    case Wait::kOver:
      result_.aborted = why_late(seen);
      if (!result_.aborted.empty()) break;
      // Twice the time that is left, and 10 s.
      return move_on(At::kRunning,
                     now_ns + 2 * (last_tick() - seen.newest_tick()) * kNsPerTick + 10'000'000'000);
    case Wait::kStopped:
      result_.aborted = trouble_.why_stopped(seen, "");
      break;
    case Wait::kTooLong:
      // A process without input cannot prepare: the first that stands still is the cause.
      result_.aborted = stands.empty() ? why_not_armed(seen) : stands;
      break;
  }
  announce_idle(actions);
  return end(seen);
}

std::string TrialRun::why_not_armed(const Seen& seen) const {
  std::vector<std::string> reasons;
  for (const Member& member : roster_) {
    if (armed(seen, member)) continue;
    std::string why = fmt::format("{} was not prepared within 10 s", member.name);
    for (const EventSeen& event : seen.events) {
      if (event.kind != EventKind::kNote || event.source != member.name) continue;
      // The trial was announced several times; each reason is given once.
      const std::string reason = fmt::format(" ({})", event.text);
      if (why.find(reason) == std::string::npos) why += reason;
    }
    reasons.push_back(why);
  }
  return fmt::format("{}", fmt::join(reasons, "; "));
}

Progress TrialRun::progress(Tick now) const {
  const Trial& trial = result_.trial;
  return {trial.phase == TrialPhase::kPegged ? "identification, stick pegged"
          : trial.phase == TrialPhase::kFree ? "identification, stick free"
                                             : fmt::format("trial {}, tracking", trial.number),
          std::clamp(static_cast<double>(now - trial.start_tick) /
                         static_cast<double>(trial.duration_ticks),
                     0.0, 1.0)};
}

bool TrialRun::follow(Seen& seen, std::int64_t now_ns, Actions& actions) {
  bool stopped = false;
  bool over = false;
  if (!trouble_.settles()) {
    const Tick now = seen.newest_tick();
    actions.progress = progress(now);
    stopped = !seen.requests.trial_stopped().empty() && now < last_tick();
    // What is not recorded did not happen.
    const bool ran = std::min(now, seen.process(kRecorder).tick) >= last_tick();
    over = stopped || ran || seen.has(EventKind::kInterlockOpened);
    if (!over) result_.aborted = standstill_.look(seen, roster_, now_ns);
    over = over || !result_.aborted.empty();
    // A stop that is asked for from now on comes too late.
    seen.trial_runs = !over;
  }
  const Wait wait = trouble_.wait(over, seen, limit_ns_, now_ns);
  if (wait == Wait::kGoesOn) return false;
  result_.completed = wait == Wait::kOver && !stopped && result_.aborted.empty();
  if (wait != Wait::kOver) {
    result_.aborted = trouble_.why_stopped(seen, "the trial did not end in time");
  }
  return end_motion(seen, now_ns, actions);
}

// After something broke, the rig gets the time to bring the force to zero, and the recorder the
// time to record it.
bool TrialRun::end_motion(Seen& seen, std::int64_t now_ns, Actions& actions) {
  constexpr std::int64_t kLimit_ns = 1'500'000'000;
  const bool opened = seen.has(EventKind::kInterlockOpened);
  stopped_ = !result_.completed &&
             (!seen.requests.trial_stopped().empty() || (trouble_.silent() && !opened) ||
              (trouble_.why().empty() && (seen.interrupted || !opened)));
  if (stopped_ || !seen.requests.emergency().empty()) announce_idle(actions);
  if (result_.completed && !opened) return look_for_death(seen, now_ns);
  return move_on(At::kForceZero, now_ns + kLimit_ns);
}

// The sources of motion and force end with it; the rig does not wait for that.
void TrialRun::announce_idle(Actions& actions) {
  if (!announced_idle_) actions.announce = {SessionState::kRunning, std::nullopt};
  announced_idle_ = true;
}

bool TrialRun::await_force_zero(const Seen& seen, std::int64_t now_ns, Actions& actions) {
  constexpr std::int64_t kAfterwards_ns = 300'000'000;
  if (!stopped_ && !seen.has(EventKind::kForceZero) && now_ns < limit_ns_) return false;
  announce_idle(actions);
  afterwards_ = seen.newest_tick() + kAfterwards_ns / kNsPerTick;
  return move_on(At::kAfterwards, now_ns + kAfterwards_ns);
}

bool TrialRun::await_afterwards(Seen& seen, std::int64_t now_ns) {
  if (seen.newest_tick() < afterwards_ && now_ns < limit_ns_) return false;
  return look_for_death(seen, now_ns);
}

// A process that ends opens the interlock first, and its end is seen later: mostly 0.1 s, in one
// test more than 1 s.  Its own last line is the better reason.
bool TrialRun::look_for_death(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kLimit_ns = 3'000'000'000;
  if (!result_.aborted.empty() || !seen.has(EventKind::kInterlockOpened)) return end(seen);
  return move_on(At::kDeath, now_ns + kLimit_ns);
}

bool TrialRun::await_death(Seen& seen, std::int64_t now_ns) {
  if (trouble_.wait(false, seen, limit_ns_, now_ns) == Wait::kGoesOn) return false;
  result_.aborted = trouble_.why_stopped(seen, "");
  return end(seen);
}

bool TrialRun::end(Seen& seen) {
  seen.trial_runs = false;
  result_.stopped = !result_.completed && !seen.requests.trial_stopped().empty();
  if (result_.stopped) result_.aborted = seen.requests.trial_stopped();
  const auto opened = std::ranges::find(seen.events, EventKind::kInterlockOpened, &EventSeen::kind);
  if (opened != seen.events.end()) {
    result_.completed = false;
    if (result_.aborted.empty()) result_.aborted = opened->line;
  }
  const Misses now = seen.misses();
  result_.misses = {now.deadline - before_.deadline, now.cycle - before_.cycle,
                    now.lost_ticks - before_.lost_ticks};
  result_.events = seen.events;
  finish();
  return true;
}

}  // namespace stillhand::lab
