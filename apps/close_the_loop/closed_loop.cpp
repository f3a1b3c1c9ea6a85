// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/closed_loop.hpp"

#include <algorithm>
#include <cmath>

#include "services/contract/config_error.hpp"
#include "services/contract/expects.hpp"

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
  /// @return false when nothing more is to be done
  bool round();
  void try_model(Round& round, std::string why_not);
  [[nodiscard]] const TrialRun& newest_cancelled() const;
  [[nodiscard]] bool anything_new() const;

  Session& session_;
  const LoopOptions& options_;
  LoopResult result_;
  session::PlannedTrial cancelled_{};
  std::int64_t last_number_ = 0;
  double best_error_mm_ = 0.0;  ///< C's, then that of the C+ that was kept last
};

void Loop::paper_trials() {
  for (const session::PlannedTrial& planned : session::plan(options_.protocol)) {
    const std::string label(1, planned.label);
    step("trial " + label);
    result_.trials.push_back(session_.run(planned, label));
    if (planned.trial.phase == TrialPhase::kPegged) {
      result_.paper_model = session_.identify(result_.trials.back());
      result_.control_model = cancellation::control_model(result_.paper_model.control);
    }
    last_number_ = planned.trial.number;
    if (planned.cancellation) {
      cancelled_ = planned;
      best_error_mm_ = result_.trials.back().metrics.rms_error_mm;
    }
  }
}

// The same trial again: same motion, same target, another model.
void Loop::try_model(Round& round, std::string why_not) {
  const auto followed = [&](ControlModel model) {
    model.adapts = options_.hand;
    return model;
  };
  ControlModel model = followed(round.verdict.control.model);
  if (why_not.empty()) {
    const std::string refused = session_.use(model);
    round.augmented = refused.empty();
    if (!refused.empty()) why_not = "the canceller refused the model (" + refused + ")";
  }
  // A model that cannot be converted, or does not explain the residual, is not run on a motor: the
  // paper's model runs with adapting gain and phase.
  if (!round.augmented) {
    model = followed(cancellation::control_model(result_.paper_model.control));
    if (const std::string refused = session_.use(model); !refused.empty()) {
      throw ConfigError("the paper's model", refused, "one that the canceller accepts");
    }
    round.outcome = why_not + ": the paper's model stays, its gain and phase adapt; ";
  }
  cancelled_.trial.number = ++last_number_;
  step("trial C+");
  round.trial = session_.run(cancelled_, "C+");
  round.kept = round.trial.metrics.rms_error_mm < best_error_mm_;
  if (round.kept) {
    best_error_mm_ = round.trial.metrics.rms_error_mm;
    result_.control_model = model;
    round.outcome += "the tracking error is smaller: the model is kept";
  } else {
    const std::string refused = session_.use(result_.control_model);
    round.outcome += "the tracking error is not smaller: the last good model stays";
    if (!refused.empty()) round.outcome += ", but the canceller refused it: " + refused;
  }
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
  diagnosis::DiagnoseOptions diagnose;
  diagnose.for_each = options_.for_each;
  diagnose.progress = [&](const std::string& what) {
    return options_.progress("diagnosis: " + what);
  };
  const Evidence evidence{&result_.trial("I").measured, &result_.trial("B").measured,
                          &newest_cancelled().measured};
  Round round;
  options_.aside([&] { round.verdict = diagnose_all(evidence, options_.declared, diagnose); });
  std::string why_not = round.verdict.not_carried;
  if (why_not.empty() && round.verdict.findings.empty() &&
      round.verdict.body.verdict() == "unexplained residual") {
    why_not = "the residual has a cause that no kind of effect explains";
  }
  try_model(round, why_not);
  const bool kept = round.kept;
  result_.rounds.push_back(std::move(round));
  const auto error = [&](std::size_t n) { return result_.rounds[n].trial.metrics.rms_error_mm; };
  const std::size_t newest = result_.rounds.size() - 1;
  if (error(newest) < error(result_.final_round)) result_.final_round = newest;
  return kept;
}

LoopResult Loop::run() {
  paper_trials();
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

LoopResult close_loop(Session& session, const LoopOptions& options) {
  return Loop(session, options).run();
}

}  // namespace stillhand::close_the_loop
