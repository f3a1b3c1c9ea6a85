// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/conductor.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "services/cancellation/codec.hpp"
#include "services/runtime/process/clock.hpp"

namespace stillhand::lab {
namespace {

// From the announcement to the first tick of the ramp: time to compute a trial's motion and target.
constexpr double kLead_s = 1.0;
constexpr double kArmLimit_s = 10.0;
constexpr std::chrono::milliseconds kPollPeriod{50};
// A session of hours has fewer; what a stranger makes up must not fill the memory.
constexpr std::size_t kMostEvents = 100'000;
// Prepared before a trial may begin; the others only follow samples.
constexpr std::string_view kArmed[]{"motion", "rig", "cancellation", "display", "human_operator"};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool saw(const std::vector<stillhand_msgs::Event>& events, stillhand_msgs::EventKind kind) {
  return std::any_of(events.begin(), events.end(),
                     [kind](const auto& event) { return event.kind() == kind; });
}

stillhand_msgs::MotionKind to_idl(const session::PlannedTrial& planned) {
  if (!planned.moving) return stillhand_msgs::MOTION_STILL;
  switch (planned.motion) {
    case session::Motion::kBandNoise:
      return stillhand_msgs::MOTION_BAND_NOISE;
    case session::Motion::kRoad:
      return stillhand_msgs::MOTION_ROAD;
    case session::Motion::kRide:
      return stillhand_msgs::MOTION_RIDE;
  }
  return stillhand_msgs::MOTION_STILL;
}

}  // namespace

Conductor::Conductor(runtime::Service& service, Watch watch, Progress progress)
    : service_(service),
      watch_(std::move(watch)),
      progress_(std::move(progress)),
      control_(service.bus().publisher<stillhand_msgs::TrialControl>(topics::kTrialControl)),
      assignment_(
          service.bus().publisher<stillhand_msgs::TrialAssignment>(topics::kTrialAssignment)),
      control_model_(
          service.bus().publisher<stillhand_msgs::AugmentedModel>(topics::kAugmentedModel)) {
  const auto stored = [this](auto store) {
    {
      const std::lock_guard lock(mutex_);
      store();
    }
    news_.notify_all();
  };
  service.bus().subscribe<stillhand_msgs::ServiceStatus>(
      topics::kServiceStatus, [this, stored](const auto& status, const auto&) {
        const std::string from = status.service().c_str();
        if (std::ranges::find(topics::kServices, from) == topics::kServices.end()) return;
        stored([&] { seen_.statuses[from] = status; });
      });
  service.bus().subscribe<stillhand_msgs::Event>(
      topics::kEvent, [this, stored](const auto& event, const auto&) {
        stored([&] {
          if (seen_.events.size() < kMostEvents) seen_.events.push_back(event);
          const std::string_view text = event.text().c_str();
          if (event.source() == "recorder" && text.starts_with(topics::kRecordingNote)) {
            seen_.recording = text.substr(topics::kRecordingNote.size());
          }
        });
      });
  service.bus().subscribe<stillhand_msgs::FeedthroughModel>(
      topics::kFeedthroughModel,
      [this, stored](const auto& model, const auto&) { stored([&] { seen_.model = model; }); });
  take_requests();
}

// Every one leaves an event, obeyed or not.
void Conductor::take_requests() {
  service_.bus().subscribe<stillhand_msgs::SessionCommand>(
      topics::kSessionCommand, [this](const auto& command, const auto&) {
        std::string told;
        {
          const std::lock_guard lock(mutex_);
          told = seen_.requests.take(command, seen_.trial_runs);
        }
        news_.notify_all();
        if (!told.empty()) service_.note_event(stillhand_msgs::EVENT_COMMAND, told.c_str());
      });
}

bool Conductor::wait_for(double limit_s, const std::function<bool(Seen&)>& done) {
  const std::int64_t limit_ns = runtime::monotonic_ns() + static_cast<std::int64_t>(limit_s * 1e9);
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      if (done(seen_)) return true;
      news_.wait_for(lock, kPollPeriod);
      if (done(seen_)) return true;
      if (trouble_.empty()) trouble_ = seen_.requests.emergency();
    }
    if (const auto ended = watch_()) {
      // Ctrl-C reaches a process that is just being started, too: it is no reason of its own.
      runtime::sleep_until_ns(runtime::monotonic_ns() + runtime::kNsPerSecond / 20);
      if (interrupted()) return false;
      silent_ = ended->pid == 0;
      mendable_ = ended->exit_status == 2 && !ended->said.empty();
      trouble_ = mendable_ ? ended->said : describe(*ended);
    }
    if (!trouble_.empty() || interrupted()) return false;
    if (runtime::monotonic_ns() > limit_ns) return false;
  }
}

void Conductor::throw_trouble() const {
  if (mendable_) throw RefusedByProcess(trouble_);
  if (!trouble_.empty()) throw std::runtime_error(trouble_);
}

std::vector<std::string> Conductor::absent(const Seen& seen) const {
  std::vector<std::string> absent;
  for (const std::string_view service : topics::kServices) {
    if (service == "experiment") continue;
    const auto status = seen.statuses.find(std::string(service));
    if (status == seen.statuses.end()) {
      absent.push_back(std::string(service) + " did not come");
    } else if (status->second.state() == stillhand_msgs::SERVICE_STARTING) {
      absent.push_back(std::string(service) + " waits for " + status->second.missing().c_str());
    }
  }
  return absent;
}

void Conductor::await_everybody(double limit_s) {
  const bool complete = wait_for(limit_s, [this](Seen& seen) {
    const auto missing = absent(seen);
    const auto total = static_cast<double>(topics::kServices.size() - 1);
    progress_("matching endpoints", 1.0 - static_cast<double>(missing.size()) / total);
    return missing.empty() && service_.bus().missing_peers().empty();
  });
  const auto twice = service_.bus().duplicate_peers();
  if (!twice.empty()) {
    throw std::runtime_error("on domain " + std::to_string(service_.options().domain) + " rig " +
                             std::to_string(service_.options().rig) + " there is more than one " +
                             joined(twice) +
                             ": another lab runs; choose another --domain or --rig");
  }
  if (complete) return;
  throw_trouble();
  if (interrupted()) return;
  const std::lock_guard lock(mutex_);
  auto missing = absent(seen_);
  for (const std::string& peer : service_.bus().missing_peers()) {
    missing.push_back("experiment waits for " + peer);
  }
  throw std::runtime_error("not everybody matched within " +
                           std::to_string(static_cast<int>(limit_s)) + " s: " + joined(missing));
}

void Conductor::announce(const session::PlannedTrial* planned,
                         stillhand_msgs::SessionState session) {
  stillhand_msgs::TrialControl message;
  message.session(session);
  message.trial(-1);
  message.phase(stillhand_msgs::PHASE_IDLE);
  if (planned != nullptr) {
    message.trial(static_cast<std::int32_t>(planned->trial.number));
    message.phase(planned->trial.phase == TrialPhase::kPegged ? stillhand_msgs::PHASE_PEGGED
                                                              : stillhand_msgs::PHASE_TRACKING);
    message.start_tick(planned->trial.start_tick);
    message.duration_ticks(planned->trial.duration_ticks);
    message.ramp_ticks(planned->trial.ramp_ticks);
    message.reference_seed(planned->reference_seed);
  }
  service_.follow_session(session);
  control_.write(message);
}

void Conductor::assign(const session::PlannedTrial& planned) {
  stillhand_msgs::TrialAssignment message;
  message.trial(static_cast<std::int32_t>(planned.trial.number));
  message.motion(to_idl(planned));
  message.band_low_hz(planned.band_low_hz);
  message.band_high_hz(planned.band_high_hz);
  message.band_order(planned.band_order);
  message.rms_m_s2(planned.rms_m_s2);
  message.peak_m_s2(planned.peak_m_s2);
  message.motion_seed(planned.motion_seed);
  message.cancellation(planned.cancellation);
  assignment_.write(message);
}

Tick Conductor::newest_tick() {
  const std::lock_guard lock(mutex_);
  const auto rig = seen_.statuses.find("rig");
  return rig == seen_.statuses.end() ? -1 : rig->second.tick();
}

void Conductor::begin_session() {
  announce(nullptr, stillhand_msgs::SESSION_RUNNING);
  const bool ticking = wait_for(5.0, [](Seen& seen) {
    return std::all_of(seen.statuses.begin(), seen.statuses.end(), [](const auto& entry) {
      return entry.first == "experiment" || entry.first == "human_operator" ||
             entry.first == "identification" || entry.second.tick() >= 0;
    });
  });
  throw_trouble();
  if (!ticking && !interrupted()) {
    throw std::runtime_error("the sample clock did not start within 5 s");
  }
}

std::string Conductor::why_not_armed(const Seen& seen, std::string_view service) {
  std::string why = std::string(service) + " was not prepared within 10 s";
  for (const stillhand_msgs::Event& event : seen.events) {
    if (event.kind() == stillhand_msgs::EVENT_NOTE && event.source().c_str() == service) {
      why += std::string(" (") + event.text().c_str() + ")";
    }
  }
  return why;
}

bool Conductor::await_armed(const session::PlannedTrial& planned, session::TrialOutcome& outcome) {
  const auto number = planned.trial.number;
  const bool armed = wait_for(kArmLimit_s, [&](Seen& seen) {
    return std::all_of(std::begin(kArmed), std::end(kArmed), [&](std::string_view service) {
      return seen.statuses[std::string(service)].armed_trial() == number;
    });
  });
  if (armed) return true;
  outcome.aborted = why_stopped("");
  if (outcome.aborted.empty()) {
    const std::lock_guard lock(mutex_);
    for (const std::string_view service : kArmed) {
      if (seen_.statuses[std::string(service)].armed_trial() != number) {
        outcome.aborted += (outcome.aborted.empty() ? "" : "; ") + why_not_armed(seen_, service);
      }
    }
  }
  return false;
}

void Conductor::pause() {
  const std::lock_guard lock(mutex_);
  seen_.requests.pause();
}

// What is asked from here on is asked of the trial.
bool Conductor::await_start(const session::PlannedTrial& planned, session::MissCounts& before) {
  constexpr double kForEver_s = 1e9;
  bool waited = false;
  return wait_for(kForEver_s, [&](Seen& seen) {
    if (!seen.requests.paused() && seen.requests.emergency().empty()) {
      seen.events.clear();
      seen.requests.begin_trial();
      seen.trial_runs = true;
      before = count(seen);
      return true;
    }
    if (!std::exchange(waited, true)) announce(nullptr, stillhand_msgs::SESSION_PAUSED);
    progress_("paused before trial " + std::to_string(planned.trial.number) +
                  ", for a start from the dashboard",
              0.0);
    return false;
  });
}

session::TrialOutcome Conductor::run(session::PlannedTrial planned) {
  session::TrialOutcome outcome;
  outcome.planned = planned;
  session::MissCounts before;
  if (!await_start(planned, before)) {
    outcome.aborted = why_stopped("");
    return outcome;
  }
  planned.trial.start_tick = newest_tick() + ticks_in(kLead_s) + planned.trial.ramp_ticks;
  assign(planned);
  announce(&planned, stillhand_msgs::SESSION_RUNNING);
  outcome.planned = planned;
  if (await_armed(planned, outcome)) follow(planned, outcome);
  {
    const std::lock_guard lock(mutex_);
    seen_.trial_runs = false;
    outcome.stopped = !outcome.completed && !seen_.requests.trial_stopped().empty();
    if (outcome.stopped) outcome.aborted = seen_.requests.trial_stopped();
  }
  collect(outcome, before);
  return outcome;
}

void Conductor::follow(const session::PlannedTrial& planned, session::TrialOutcome& outcome) {
  const Trial& trial = planned.trial;
  const Tick end = trial.start_tick + trial.duration_ticks + trial.ramp_ticks;
  const double limit_s = 2.0 * static_cast<double>(end - newest_tick()) * kControlPeriod_s + 10.0;
  bool stopped = false;
  const bool came = wait_for(limit_s, [&](Seen& seen) {
    const Tick now = seen.statuses["rig"].tick();
    progress_(trial.phase == TrialPhase::kPegged
                  ? "identification, stick pegged"
                  : "trial " + std::to_string(trial.number) + ", tracking",
              std::clamp(static_cast<double>(now - trial.start_tick) /
                             static_cast<double>(trial.duration_ticks),
                         0.0, 1.0));
    stopped = !seen.requests.trial_stopped().empty() && now < end;
    // Who asks for its stop now comes too late.
    seen.trial_runs =
        !stopped && now < end && !saw(seen.events, stillhand_msgs::EVENT_INTERLOCK_OPENED);
    return !seen.trial_runs;
  });
  outcome.completed = came && !stopped;
  if (!came) outcome.aborted = why_stopped("the trial did not end in time");
  see_force_out(outcome.completed);
  look_for_death(outcome);
}

// After something broke, the rig gets the time to bring the force to zero and the recorder to see
// it.
void Conductor::see_force_out(bool completed) {
  constexpr std::chrono::milliseconds kLimit{1500};
  constexpr std::chrono::milliseconds kAfterwards{300};
  std::unique_lock lock(mutex_);
  // Asked for: no trial, no force, and no event that it opened.
  const bool unheard = silent_ && !saw(seen_.events, stillhand_msgs::EVENT_INTERLOCK_OPENED);
  const bool stopped = !completed && (!seen_.requests.trial_stopped().empty() || unheard ||
                                      (trouble_.empty() && interrupted()));
  if (stopped || !seen_.requests.emergency().empty()) {
    announce(nullptr, stillhand_msgs::SESSION_RUNNING);
  }
  if (completed && !saw(seen_.events, stillhand_msgs::EVENT_INTERLOCK_OPENED)) return;
  news_.wait_for(lock, kLimit,
                 [&] { return stopped || saw(seen_.events, stillhand_msgs::EVENT_FORCE_ZERO); });
  const Tick now = seen_.statuses["rig"].tick();
  news_.wait_for(lock, kAfterwards,
                 [&] { return seen_.statuses["rig"].tick() >= now + kAfterwards.count(); });
}

// A process that ends opens the interlock first and can be seen to have ended a little later; what
// it said is the better reason.
void Conductor::look_for_death(session::TrialOutcome& outcome) {
  constexpr double kLimit_s = 1.0;
  {
    const std::lock_guard lock(mutex_);
    if (!outcome.aborted.empty() || !saw(seen_.events, stillhand_msgs::EVENT_INTERLOCK_OPENED)) {
      return;
    }
  }
  wait_for(kLimit_s, [](Seen&) { return false; });
  outcome.aborted = why_stopped("");
}

session::MissCounts Conductor::count(const Seen& seen) {
  session::MissCounts counts;
  for (const auto& [service, status] : seen.statuses) {
    for (const stillhand_msgs::TopicStatus& topic : status.topics()) {
      if (topic.written()) continue;
      counts.deadline += static_cast<std::int64_t>(topic.deadline_misses());
      counts.cycle += static_cast<std::int64_t>(topic.cycle_misses());
      counts.lost_ticks += static_cast<std::int64_t>(topic.lost_ticks());
    }
  }
  return counts;
}

void Conductor::collect(session::TrialOutcome& outcome, const session::MissCounts& before) {
  const std::lock_guard lock(mutex_);
  for (const stillhand_msgs::Event& event : seen_.events) {
    const session::Mark mark = session::mark_of(event);
    session::add_mark(outcome.marks, mark);
    if (event.kind() == stillhand_msgs::EVENT_INTERLOCK_OPENED) {
      outcome.completed = false;
      if (outcome.aborted.empty()) outcome.aborted = session::line_of(mark);
    }
  }
  const session::MissCounts now = count(seen_);
  outcome.misses = {now.deadline - before.deadline, now.cycle - before.cycle,
                    now.lost_ticks - before.lost_ticks};
}

std::optional<stillhand_msgs::FeedthroughModel> Conductor::await_model(std::int64_t trial,
                                                                       double limit_s) {
  std::optional<stillhand_msgs::FeedthroughModel> model;
  wait_for(limit_s, [&](Seen& seen) {
    if (seen.model && seen.model->trial() == trial) model = seen.model;
    return model.has_value();
  });
  return model;
}

std::string Conductor::use(const cancellation::ControlModel& model) {
  constexpr double kLimit_s = 5.0;
  {
    const std::lock_guard lock(mutex_);
    seen_.events.clear();
  }
  auto message = cancellation::to_idl(model, cancellation::kFirstControlModel + models_++);
  message.from_tick(newest_tick() + kModelNotice_ticks);
  control_model_.write(message);
  std::string refused;
  const bool answered = wait_for(kLimit_s, [&](Seen& seen) {
    return std::ranges::any_of(seen.events, [&](const stillhand_msgs::Event& event) {
      if (event.kind() == stillhand_msgs::EVENT_MODEL_REFUSED) refused = event.text().c_str();
      return event.kind() == stillhand_msgs::EVENT_MODEL_REFUSED ||
             event.kind() == stillhand_msgs::EVENT_MODEL_LOADED;
    });
  });
  return answered ? refused : why_stopped("the canceller did not answer");
}

std::string Conductor::why_stopped(const std::string& otherwise) const {
  return !trouble_.empty() ? trouble_ : interrupted() ? "interrupted" : otherwise;
}

std::string Conductor::recording() {
  const std::lock_guard lock(mutex_);
  return seen_.recording;
}

void Conductor::end_session() { announce(nullptr, stillhand_msgs::SESSION_ENDING); }

}  // namespace stillhand::lab
