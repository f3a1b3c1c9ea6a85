// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/conductor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "apps/lab/codec.hpp"
#include "apps/lab/core/asking.hpp"
#include "apps/lab/core/model_stages.hpp"
#include "apps/lab/core/rest.hpp"
#include "apps/lab/core/session_begin.hpp"
#include "apps/lab/core/trial_run.hpp"
#include "services/bus/sources_codec.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/cpu_share.hpp"

namespace stillhand::lab {
namespace {

constexpr std::chrono::milliseconds kPollPeriod{50};
// A session of hours has fewer; made-up events must not fill the memory.
constexpr std::size_t kMostEvents = 100'000;
// Between two looks of a prompt; the display repeats its answer.
constexpr std::size_t kMostAnswers = 16;
// Between two looks; one at a time is what the watch sends.
constexpr std::size_t kMostModelChanges = 16;
// Of five sessions that took 1.6 to 1.9 of two cores, one was ended as late (2026-11-29).
constexpr double kFullShare = 0.8;

// In the order of the launches, which is that of the data flow.
Roster roster() {
  Roster members;
  for (const std::string_view name : topics::kLaunchOrder) {
    const auto& process = *std::ranges::find(topics::kProcesses, name, &topics::Process::name);
    members.push_back({std::string(name), process.prepares, process.ticks});
  }
  return members;
}

Death death_of(const Ended& ended) {
  const bool refused = ended.exit_status == 2 && !ended.said.empty();
  return {refused ? ended.said : describe(ended), refused, ended.pid == 0};
}

// What an operator can mend where a process is missing, late or silent.
std::string of_full_processors(double busy_share) {
  if (!(busy_share >= kFullShare)) return {};
  return fmt::format("; this machine's processors were busy for {:.0f} % of the time",
                     100.0 * busy_share);
}

}  // namespace

Conductor::Conductor(runtime::Service& service, Watch watch, Show show, Say say)
    : service_(service),
      watch_(std::move(watch)),
      show_(std::move(show)),
      say_(std::move(say)),
      roster_(roster()),
      control_(service.bus().publisher<stillhand_msgs::TrialControl>(topics::kTrialControl)),
      assignment_(
          service.bus().publisher<stillhand_msgs::TrialAssignment>(topics::kTrialAssignment)),
      control_model_(
          service.bus().publisher<stillhand_msgs::AugmentedModel>(topics::kAugmentedModel)),
      sources_(service.bus().publisher<stillhand_msgs::SessionSources>(topics::kSessionSources)),
      prompts_(service.bus().publisher<stillhand_msgs::Prompt>(topics::kPrompt)),
      emergency_stop_(service.bus(), "the stop key") {
  model_.trial(-1);  // none yet; 0 is the pegged trial
  subscribe();
}

void Conductor::subscribe() {
  const auto stored = [this](auto store) {
    {
      const std::lock_guard lock(mutex_);
      store();
      fresh_ = true;
    }
    news_.notify_all();
  };
  runtime::Bus& bus = service_.bus();
  bus.subscribe<stillhand_msgs::ServiceStatus>(
      topics::kServiceStatus, [this, stored](const auto& status, const auto&) {
        const std::string from = status.service().c_str();
        if (!topics::is_service(from)) return;
        stored([&] { seen_.take(from, from_idl(status)); });
      });
  bus.subscribe<stillhand_msgs::Event>(
      topics::kEvent, [this, stored](const auto& message, const auto&) {
        EventSeen event = from_idl(message);
        stored([&] {
          if (event.source == topics::kEndsLast && event.text.starts_with(topics::kRecordingNote)) {
            recording_ = event.text.substr(topics::kRecordingNote.size());
          }
          if (event.source == topics::kEndsLast && message.code() == stillhand_msgs::CODE_RECORDED)
            seen_.recorded_tick = std::max(seen_.recorded_tick, event.tick);
          if (message.code() == stillhand_msgs::CODE_MODEL_CHANGED &&
              model_changes_.size() < kMostModelChanges)
            model_changes_.push_back(mark_of(event));
          if (seen_.events.size() < kMostEvents) seen_.events.push_back(std::move(event));
        });
      });
  bus.subscribe<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel,
                                                  [this, stored](const auto& model, const auto&) {
                                                    stored([&] {
                                                      model_ = model;
                                                      seen_.model = from_idl(model);
                                                    });
                                                  });
  bus.subscribe<stillhand_msgs::Answer>(topics::kAnswer,
                                        [this, stored](const auto& answer, const auto&) {
                                          stored([&] {
                                            if (seen_.answers.size() < kMostAnswers)
                                              seen_.answers.push_back(from_idl(answer));
                                          });
                                        });
  // Every request leaves an event, whether it is obeyed or not.
  bus.subscribe<stillhand_msgs::SessionCommand>(
      topics::kSessionCommand,
      [this, stored](const auto& command, const runtime::Arrival& arrival) {
        std::string reported;
        bool aborted = false;
        stored([&] {
          reported = seen_.requests.take(from_idl(command, arrival.participant), seen_.trial_runs);
          aborted = !seen_.requests.aborted().empty();
        });
        if (aborted) service_.stop().request();
        if (!reported.empty()) {
          service_.note_event(stillhand_msgs::EVENT_COMMAND, reported.c_str());
        }
      });
}

// What does not come by a callback.
void Conductor::look(bool with_peers) {
  std::vector<std::string> missing, duplicate;
  if (with_peers) {
    missing = service_.bus().missing_peers();
    duplicate = service_.bus().duplicate_peers();
    if (missing.empty() && duplicate.empty()) name_sources();
  }
  // One end at a time: the core takes it a little later.
  std::optional<Ended> ended;
  if (!seen_.ended) ended = watch_();
  const std::lock_guard lock(mutex_);
  seen_.missing_peers = std::move(missing);
  seen_.duplicate_peers = std::move(duplicate);
  if (ended) seen_.ended = death_of(*ended);
  seen_.interrupted = interrupted();
}

// Every process is there, once.  It reports that it is ready when it knows the sources, so the
// sample clock starts after that.
void Conductor::name_sources() {
  if (named_sources_) return;
  runtime::Bus& bus = service_.bus();
  const std::vector<runtime::Source> sources = bus.sources_found();
  if (!bus.take_sources(bus.participant(), sources)) return;
  {
    // What came before may be anybody's; each process says it again.
    const std::lock_guard lock(mutex_);
    seen_.processes.clear();
    seen_.events.clear();
    recording_.clear();
  }
  named_sources_ = runtime::to_idl(sources);
  repeat_sources();
}

// Who lost sight of this process during a pause, since it stood still, also forgot what it named.
// DDS matches the two again and does not send the message again.
void Conductor::repeat_sources() {
  if (named_sources_) sources_.write(*named_sources_);
}

void Conductor::run_stage(Stage& stage, bool with_peers) {
  while (!stage.over()) {
    look(with_peers);
    Actions actions;
    {
      const std::lock_guard lock(mutex_);
      fresh_ = false;
      actions = stage.step(seen_, runtime::monotonic_ns());
    }
    perform(actions);
    say_model_changes();
    std::unique_lock lock(mutex_);
    if (!stage.over()) news_.wait_for(lock, kPollPeriod, [this] { return fresh_; });
  }
}

void Conductor::say_model_changes() {
  std::vector<session::Mark> changes;
  {
    const std::lock_guard lock(mutex_);
    changes.swap(model_changes_);
  }
  if (!say_ || !planned_) return;
  for (const session::Mark& change : changes) {
    say_(session::model_change(change, planned_->trial));
  }
}

void Conductor::perform(const Actions& actions) {
  if (actions.assign) {
    repeat_sources();
    planned_->trial = *actions.assign;
    auto message = assignment_of(*planned_);
    assignment_.write(message);
  }
  if (actions.announce) announce(*actions.announce);
  if (actions.give_model_from) {
    given_.from_tick(*actions.give_model_from);
    control_model_.write(given_);
  }
  if (actions.progress) show_(*actions.progress);
  if (actions.note) note(*actions.note);
}

void Conductor::announce(const Announcement& announcement) {
  auto message = to_idl(announcement, planned_ ? planned_->reference_seed : 0);
  service_.follow_session(message.session());
  control_.write(message);
}

void Conductor::throw_trouble() const {
  if (trouble_.refused()) throw RefusedByProcess(trouble_.why());
  if (!trouble_.why().empty()) throw std::runtime_error(trouble_.why());
}

void Conductor::await_everybody(double limit_s) {
  const runtime::ServiceOptions& options = service_.options();
  Matching matching(roster_, fmt::format("domain {} rig {}", options.domain, options.rig), limit_s,
                    trouble_);
  run_stage(matching, true);
  if (!matching.failure().empty()) throw std::runtime_error(matching.failure());
  if (!matching.complete()) throw_trouble();
}

void Conductor::begin_session() {
  ClockStart start(roster_, trouble_);
  run_stage(start);
  throw_trouble();
  if (!start.failure().empty()) throw std::runtime_error(start.failure());
}

void Conductor::pause() {
  const std::lock_guard lock(mutex_);
  seen_.requests.pause();
}

void Conductor::rest(const std::string& what, double seconds, const std::function<bool()>& over) {
  Rest rest(what, seconds, trouble_, over);
  run_stage(rest);
}

void Conductor::show(const Prompt& prompt) {
  Tick now = -1;
  {
    const std::lock_guard lock(mutex_);
    now = seen_.newest_tick();
  }
  auto message = to_idl(prompt, ++shown_, now);
  prompts_.write(message);
}

std::optional<std::int64_t> Conductor::ask(const Prompt& prompt, const std::string& what) {
  {
    const std::lock_guard lock(mutex_);
    seen_.answers.clear();
  }
  show(prompt);
  Asking asking(what, shown_, prompt.steps, prompt.wait_s, trouble_);
  run_stage(asking);
  if (!asking.answer()) throw_trouble();
  return asking.answer();
}

Asked Conductor::asked() {
  const std::lock_guard lock(mutex_);
  return seen_.requests.take_asked();
}

bool Conductor::was_late(const TrialResult& result) {
  const std::lock_guard lock(mutex_);
  return !seen_.interrupted && seen_.requests.emergency().empty() &&
         std::ranges::find(result.events, EventKind::kInterlockOpened, &EventSeen::kind) !=
             result.events.end();
}

session::TrialOutcome Conductor::run(const session::PlannedTrial& planned) {
  planned_ = planned;
  TrialRun trial(planned.trial, roster_, trouble_);
  runtime::HostCpu processors;
  processors.step();
  run_stage(trial);
  const TrialResult& result = trial.result();
  session::TrialOutcome outcome;
  outcome.planned = planned;
  outcome.planned.trial = result.trial;
  outcome.completed = result.completed;
  outcome.stopped = result.stopped;
  outcome.aborted = result.aborted;
  if (!outcome.completed && !outcome.stopped && was_late(result)) {
    outcome.aborted += of_full_processors(processors.step());
  }
  for (const EventSeen& event : result.events) session::add_mark(outcome.marks, mark_of(event));
  if (outcome.completed) {
    const Trial& ended = result.trial;
    RecordingWait wait(ended.start_tick + ended.duration_ticks + ended.ramp_ticks, trouble_);
    run_stage(wait);
    outcome.completed = wait.failure().empty();
    outcome.aborted = wait.failure();
  }
  outcome.misses = {result.misses.deadline, result.misses.cycle, result.misses.lost_ticks};
  return outcome;
}

Conductor::AwaitedModel Conductor::await_model(std::int64_t trial) {
  ModelWait wait(trial, trouble_);
  run_stage(wait);
  const std::lock_guard lock(mutex_);
  return {model_, wait.failure()};
}

std::string Conductor::use(const cancellation::ControlModel& model) {
  given_ = cancellation::to_idl(model, cancellation::kFirstControlModel + models_++);
  ModelUse use(trouble_);
  run_stage(use);
  if (!use.failure().empty())
    throw std::runtime_error("a model for the canceller: " + use.failure());
  return use.refusal();
}

std::string Conductor::recording() {
  const std::lock_guard lock(mutex_);
  return recording_;
}

void Conductor::end_session() { announce({SessionState::kEnding, std::nullopt}); }

}  // namespace stillhand::lab
