// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/live_closing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <optional>

#include "apps/lab/control_model.hpp"
#include "apps/lab/output_folder.hpp"
#include "apps/lab/processes.hpp"
#include "apps/lab/typed_line.hpp"
#include "services/core/contract/tick.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::lab {
namespace {

constexpr double kDiagnosis_s = 180.0;
constexpr double kOffer_s = 30.0;
constexpr double kDiagnosisEnds_s = 1.0;

bool lost_its_model(const session::TrialOutcome& outcome) {
  return outcome.planned.label == session::Condition::kC &&
         std::ranges::any_of(outcome.marks, [&](const session::Mark& mark) {
           return !session::model_change(mark, outcome.planned.trial).empty();
         });
}

std::filesystem::path folder_of(const LabOptions& options) { return options.out / kClosingFolder; }

// The verb that a person would start after the session, below every process of the session.
Launch diagnosis_of(const LabOptions& options) {
  Launch launch;
  launch.name = "diagnosis";
  launch.executable = "nice";
  launch.log = options.out / "logs" / "closing.log";
  launch.arguments = {"-n",
                      "10",
                      (options.programs / "stillhand").string(),
                      "close-the-loop",
                      "--pegged",
                      (options.out / "session.mcap").string(),
                      "--rig",
                      fmt::to_string(options.rig),
                      "--threads",
                      fmt::to_string(std::max(1u, runtime::core_count() / 2)),
                      "--out",
                      folder_of(options).string()};
  return launch;
}

}  // namespace

std::vector<session::PlannedTrial> closing_trials(const session::ProtocolOptions& protocol) {
  const auto number = static_cast<std::int64_t>(session::plan(protocol).size());
  return {session::identification_again(protocol, number),
          session::tracking_trial(protocol, session::Condition::kC, number + 1)};
}

bool LiveClosing::after(const session::TrialOutcome& outcome) {
  return !lost_its_model(outcome) || close();
}

bool LiveClosing::close() {
  trials_.show({.kind = PromptKind::kIdentification});
  const session::TrialOutcome identified =
      trials_.run_between(closing_trials(options_.protocol).front());
  if (!identified.completed) return false;
  if (!identified.no_model.empty()) {
    trials_.say("the session goes on with its model: " + identified.no_model);
    return true;
  }
  const std::int64_t next = identified.planned.trial.number + 1;
  const PauseVerdict verdict = diagnose();
  if (trials_.interrupted()) return false;
  if (!verdict.why_not.empty()) {
    trials_.say(
        fmt::format("trial {} runs C with the model identified again: {}", next, verdict.why_not));
    return run_again(false);
  }
  return run_again(takes(verdict, next) && give_plus(next));
}

PauseVerdict LiveClosing::diagnose() {
  Processes processes;
  std::optional<Ended> ended;
  try {
    processes.start(diagnosis_of(options_));
    trials_.rest("diagnosis of the identification", kDiagnosis_s, [&] {
      if (!ended) ended = processes.reap();
      return ended.has_value();
    });
    if (!ended) {
      processes.end("diagnosis", kDiagnosisEnds_s);
      return {.why_not = "its diagnosis was not ready"};
    }
    if (ended->exit_status != 0) return {.why_not = describe(*ended)};
    return pause_verdict(recording::read_file((folder_of(options_) / "summary.json").string()));
  } catch (const std::exception& error) {
    return {.why_not = std::string("it was not diagnosed: ") + error.what()};
  }
}

bool LiveClosing::takes(const PauseVerdict& verdict, std::int64_t number) {
  if (options_.headless || !TypedLine::possible()) {
    trials_.say(fmt::format("C+ {} for trial {}, {}", verdict.certain ? "taken" : "not taken",
                            number, verdict.found));
    return verdict.certain;
  }
  trials_.say(
      fmt::format("C+ offered for trial {}, {}; enter y within {:.0f} s to run it, else C "
                  "goes on",
                  number, verdict.found, kOffer_s));
  TypedLine line;
  trials_.rest("C+ is offered", kOffer_s, [&] { return line.is_there(); });
  const bool taken = line.text() == "y";
  trials_.say(fmt::format("C+ {} for trial {}", taken ? "taken" : "not taken", number));
  return taken;
}

bool LiveClosing::give_plus(std::int64_t number) {
  std::string refused;
  try {
    cancellation::ControlModel plus =
        control_model(folder_of(options_) / "control_model.json", options_.rig, options_.config);
    plus.adapts.reset();  // neither what judged it nor C follows the hand
    refused = trials_.use(plus);
  } catch (const std::exception& error) {
    refused = error.what();
  }
  if (refused.empty()) return true;
  trials_.say(fmt::format("C+ does not run in trial {}: {}", number, refused));
  return false;
}

bool LiveClosing::run_again(bool plus) {
  if (trials_.interrupted()) return false;
  session::PlannedTrial again = closing_trials(options_.protocol).back();
  if (plus) again.label = session::Condition::kCPlus;
  trials_.show({.kind = PromptKind::kTrial, .wait_s = kTrialLead_s + options_.protocol.ramp_s});
  if (!trials_.run_between(again).completed) return false;
  // What the plan still has begins with the session's own model, as it would have.
  return !plus || trials_.use(cancellation::control_model(trials_.model().control)).empty();
}

}  // namespace stillhand::lab
