// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/session/closed_loop.hpp"

#include <algorithm>
#include <cmath>

#include "apps/libraries/measurement/grid.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::close_the_loop {
namespace {

using cancellation::ControlModel;

class Loop {
 public:
  Loop(Session& session, const LoopOptions& options) : session_(session), options_(options) {}

  LoopResult run();

 private:
  void step(const std::string& name) const {
    if (!options_.progress(name)) throw diagnosis::Interrupted();
  }
  void paper_trials();
  void followed_trial();
  /// @return false when nothing more is to be done
  bool round();
  void try_model(Round& round, std::string why_not);
  /// Gives the canceller a model that it must take.
  void use_sound(const ControlModel& model);
  /// The trial of C again with the model that the canceller has: same motion, same target.
  TrialRun again(const std::string& label);
  /// Keeps the trial's model if it is the best so far; otherwise that one is used again.
  bool keep_if_best(const TrialRun& trial, const ControlModel& model);
  [[nodiscard]] ControlModel followed(ControlModel model) const {
    model.adapts = options_.hand;
    return model;
  }
  [[nodiscard]] const TrialRun& newest_cancelled() const;
  [[nodiscard]] bool anything_new() const;

  Session& session_;
  const LoopOptions& options_;
  LoopResult result_;
  session::PlannedTrial cancelled_{};
  double best_error_mm_ = 0.0;  ///< C's, then that of the best C' or C+
};

// Why the verdict's model is not run on a motor; empty: it is.
std::string why_not_augmented(const Verdict& verdict) {
  if (!verdict.not_carried.empty()) return verdict.not_carried;
  if (verdict.strongest() != nullptr) return {};
  if (verdict.conclusion() == kNoModel) return "the acceleration does not explain the force";
  return verdict.conclusion() == kUnexplained
             ? "the residual has a cause that no kind of effect explains"
             : "nothing is missing that counts";
}

void Loop::paper_trials() {
  for (const session::PlannedTrial& planned : session::plan(options_.protocol)) {
    const std::string label = session::name_of(planned.label);
    step("trial " + label);
    result_.trials.push_back(session_.run(planned, label));
    if (planned.trial.phase == TrialPhase::kPegged) {
      result_.paper_model = session_.identify(result_.trials.back());
      result_.control_model = cancellation::control_model(result_.paper_model.control);
    }
    if (planned.cancellation) {
      cancelled_ = planned;
      best_error_mm_ = result_.trials.back().metrics.rms_error_mm;
    }
  }
}

void Loop::use_sound(const ControlModel& model) {
  if (const std::string refused = session_.use(model); !refused.empty()) {
    throw ConfigError("the canceller's model", refused, "one that the canceller accepts");
  }
}

TrialRun Loop::again(const std::string& label) {
  step("trial " + label);
  return session_.run(cancelled_, label);
}

bool Loop::keep_if_best(const TrialRun& trial, const ControlModel& model) {
  if (trial.metrics.rms_error_mm < best_error_mm_) {
    best_error_mm_ = trial.metrics.rms_error_mm;
    result_.control_model = model;
    return true;
  }
  use_sound(result_.control_model);
  return false;
}

void Loop::followed_trial() {
  result_.followed_model = followed(cancellation::control_model(result_.paper_model.control));
  use_sound(result_.followed_model);
  result_.trials.push_back(again("C'"));
  keep_if_best(result_.trials.back(), result_.followed_model);
}

void Loop::try_model(Round& round, std::string why_not) {
  if (why_not.empty()) {
    round.model = followed(round.verdict.control.model);
    const std::string refused = session_.use(round.model);
    round.augmented = refused.empty();
    if (!refused.empty()) why_not = "the canceller refused the model (" + refused + ")";
  }
  // A model that cannot be converted, or does not explain the residual, is not run on a motor.
  if (!round.augmented) {
    round.model = result_.followed_model;
    round.trial = result_.trial("C'");
    round.trial.label = "C+";
    round.outcome = why_not + ": C+ is C'";
    return;
  }
  round.trial = again("C+");
  round.better = keep_if_best(round.trial, round.model);
  round.outcome = round.better ? "the tracking error is smaller in its trial"
                               : "the tracking error is not smaller in its trial";
}

const TrialRun& Loop::newest_cancelled() const {
  return result_.rounds.empty() ? result_.trial("C") : result_.rounds.back().trial;
}

// I and B do not change: the new fact in C+ is the delay of its motor and its load cell.
bool Loop::anything_new() const {
  if (result_.rounds.empty()) return true;
  const auto& before = result_.rounds.back().verdict.latency;
  const auto now = measure_latency(newest_cancelled().measured, options_.declared);
  if (!before || !now) return false;
  return std::abs(now->motor_s - before->motor_s) >= kWorthLatency_s ||
         std::abs(now->cell_s - before->cell_s) >= kWorthLatency_s;
}

bool Loop::round() {
  if (!anything_new()) return false;
  step("diagnosis " + std::to_string(result_.rounds.size() + 1));
  diagnosis::DiagnoseOptions diagnose = options_.diagnose;
  diagnose.progress = [&](const std::string& what) {
    return options_.progress("diagnosis: " + what);
  };
  const diagnosis::Measurement pegged = measurement::on_grid(result_.trial("I").measured);
  Evidence evidence;
  evidence.pegged = &pegged;
  evidence.moving = {&result_.trial("B").measured};
  evidence.cancelled = {&newest_cancelled().measured};
  Round round;
  options_.aside([&] { round.verdict = diagnose_all(evidence, options_.declared, diagnose); });
  try_model(round, why_not_augmented(round.verdict));
  const bool better = round.better;
  result_.rounds.push_back(std::move(round));
  const auto error = [&](std::size_t n) { return result_.rounds[n].trial.metrics.rms_error_mm; };
  const std::size_t newest = result_.rounds.size() - 1;
  if (error(newest) < error(result_.final_round)) result_.final_round = newest;
  return better;
}

LoopResult Loop::run() {
  paper_trials();
  followed_trial();
  for (int n = 0; n < options_.most_rounds && round(); ++n) {
  }
  return std::move(result_);
}

}  // namespace

const TrialRun& LoopResult::trial(const std::string& label) const {
  const auto found = std::ranges::find(trials, label, &TrialRun::label);
  STILLHAND_EXPECTS(found != trials.end());
  return *found;
}

std::vector<const TrialRun*> cancelling_trials(const LoopResult& result) {
  return {&result.trial("C"), &result.trial("C'"), &result.plus()};
}

LoopResult close_loop(Session& session, const LoopOptions& options) {
  return Loop(session, options).run();
}

}  // namespace stillhand::close_the_loop
