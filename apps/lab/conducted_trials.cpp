// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/conducted_trials.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/control_model.hpp"
#include "apps/lab/processes.hpp"
#include "services/bus/bus.hpp"
#include "services/core/cancellation/part.hpp"
#include "services/messages/identification/codec.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::lab {
namespace {

// Looks for a service whose life sign is gone for good: the service hangs, or it ended and is no
// child of this process.  One thread.
class LostService {
 public:
  /// @param patience_s  [s] how long a life sign may be absent
  /// @param only        the service to look for; empty: every service
  LostService(const runtime::Bus& bus, double patience_s, std::string only = "")
      : bus_(bus),
        patience_ns_(static_cast<std::int64_t>(patience_s * 1e9)),
        only_(std::move(only)) {}

  std::optional<Ended> operator()() {
    std::vector<std::string> lost = bus_.lost_peers();
    std::erase_if(lost, [&](const std::string& name) { return !only_.empty() && name != only_; });
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (lost.empty()) since_ns_ = now_ns;
    if (now_ns - since_ns_ < patience_ns_) return std::nullopt;
    return Ended{lost.front(), 0, "its life sign is gone", -1, ""};
  }

 private:
  const runtime::Bus& bus_;
  std::int64_t patience_ns_;
  std::string only_;
  std::int64_t since_ns_ = runtime::monotonic_ns();
};

// The end of a child process is seen at once, with its last line.  A process that hangs is reported
// by the rig, whose interlock opens; a rig that hangs is noticed because it falls silent.  A
// network may delay a life sign for longer than this machine does.
Conductor::Watch watch_of(const runtime::Bus& bus, Processes& processes,
                          const LabOptions& options) {
  constexpr double kGone_s = 0.5;
  constexpr double kHangs_s = 3.0;
  constexpr double kHangsElsewhere_s = 10.0;
  if (options.attach) return LostService(bus, kGone_s);
  const double patience_s = options.inventory.empty() ? kHangs_s : kHangsElsewhere_s;
  return [&processes, lost = LostService(bus, patience_s, std::string(kSampleClock))]() mutable {
    const auto ended = processes.reap();
    return ended ? ended : lost();
  };
}

// The trials of an experiment are blinded to its experimenter, too: that a model fails shows that
// the motor acts.
Conductor::Say say_of(const LabOptions& options, report::ProgressLine& progress) {
  if (!options.trials.empty()) return {};
  return [&progress](const std::string& line) {
    progress.finish();
    runtime::remark(line);
  };
}

// Of the force at the pegged stick.
bool needs_model(const LabOptions& options) {
  return std::ranges::any_of(
      options.trials.empty() ? session::plan(options.protocol) : options.trials,
      [](const session::PlannedTrial& planned) {
        return planned.cancellation || cancellation::needs_force(planned.parts);
      });
}

}  // namespace

ConductedTrials::ConductedTrials(const LabOptions& options, const AskedMotions& asked,
                                 runtime::Service& service, Processes& processes,
                                 std::vector<session::TrialOutcome>& outcomes)
    : options_(options),
      asked_(asked),
      outcomes_(outcomes),
      clocks_(service),
      conductor_(
          service, watch_of(service.bus(), processes, options),
          [this](const Progress& progress) { progress_.show(progress.what, progress.done); },
          say_of(options, progress_)) {
  if (options.stop_key.empty()) return;
  stop_key_.emplace(options.stop_key, [this] { conductor_.stop_at_once(); });
}

void ConductedTrials::run(const Script& script) {
  conductor_.await_everybody(options_.match_s);
  if (conductor_.interrupted()) return;
  clocks_.start();
  conductor_.begin_session();
  script(*this);
  progress_.finish();
}

const session::TrialOutcome& ConductedTrials::run(const session::PlannedTrial& planned) {
  return run_as(planned, planned.trial.number);
}

const session::TrialOutcome& ConductedTrials::run_between(const session::PlannedTrial& planned) {
  const std::int64_t number = outcomes_.back().planned.trial.number - between_;
  ++between_;
  return run_as(planned, number);
}

std::string ConductedTrials::use(const cancellation::ControlModel& model) {
  std::string refused = conductor_.use(model);
  if (refused.empty()) {
    rest("the model settles", settled_after_s(model, options_.config), [] { return false; });
  }
  return refused;
}

void ConductedTrials::say(const std::string& line) {
  progress_.finish();
  runtime::remark(line);
}

const session::TrialOutcome& ConductedTrials::run_as(const session::PlannedTrial& planned,
                                                     std::int64_t number) {
  if (options_.wait_for_start) conductor_.pause();
  session::PlannedTrial numbered = planned;
  for (;;) {
    // A number is used once: the trial that had it is over.
    numbered.trial.number = number + between_;
    outcomes_.push_back(conductor_.run(numbered));
    if (const auto motion = asked_.find(planned.trial.number); motion != asked_.end()) {
      outcomes_.back().asked = motion->second;
    }
    if (!outcomes_.back().stopped) break;
    ++between_;
  }
  return finished();
}

const session::TrialOutcome& ConductedTrials::run_once(const session::PlannedTrial& planned) {
  if (options_.wait_for_start) conductor_.pause();
  outcomes_.push_back(conductor_.run(planned));
  return finished();
}

const session::TrialOutcome& ConductedTrials::finished() {
  session::TrialOutcome& outcome = outcomes_.back();
  // A perturbed trial on the peg is for `stillhand identify`: no model of it is needed here.
  const session::Condition label = outcome.planned.label;
  if (outcome.completed && (label == session::Condition::kIdentification ||
                            label == session::Condition::kFreeIdentification)) {
    take_model(outcome);
  }
  return outcome;
}

// Without a model there is nothing to cancel with: the session ends here, unless it cancels
// nothing, or has one.  A stick on a desk with a simulated platform has no feedthrough to identify.
void ConductedTrials::take_model(session::TrialOutcome& outcome) {
  const Conductor::AwaitedModel awaited = conductor_.await_model(outcome.planned.trial.number);
  if (awaited.failure.empty()) {
    // That of a free stick goes from identification to the canceller alone.
    if (awaited.model.to_position()) return;
    model_ = identification::from_idl(awaited.model);
    identified_ = true;
    return;
  }
  const bool answered = awaited.model.trial() == outcome.planned.trial.number;
  const bool pegged = outcome.planned.label == session::Condition::kIdentification;
  if (answered && pegged && (identified_ || !needs_model(options_))) {
    outcome.no_model = awaited.failure;
    return note(awaited.failure);
  }
  outcome.completed = false;
  outcome.aborted = awaited.failure;
}

}  // namespace stillhand::lab
