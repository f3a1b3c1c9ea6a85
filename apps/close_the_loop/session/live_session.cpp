// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/session/live_session.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/libraries/measurement/written_trial.hpp"
#include "apps/libraries/session/results.hpp"

namespace stillhand::close_the_loop {
namespace {

// A lost tick repeats the one before, as in the session's own results.
recording::Recording without_gaps(const recording::Recording& rows, const Trial& trial) {
  recording::Recording out;
  out.rate_hz = kControlRateHz;
  for (const recording::Column& column : rows.columns) {
    out.columns.push_back({column.name, column.unit, {}});
  }
  std::size_t row = 0;
  const auto tick_of = [&](std::size_t i) {
    return static_cast<Tick>(std::llround(rows.time_s[i] * kControlRateHz));
  };
  for (Tick tick = trial.start_tick; tick < trial.start_tick + trial.duration_ticks; ++tick) {
    while (row + 1 < rows.row_count() && tick_of(row + 1) <= tick) ++row;
    out.time_s.push_back(static_cast<double>(tick) / kControlRateHz);
    for (std::size_t c = 0; c < rows.columns.size(); ++c) {
      out.columns[c].values.push_back(rows.columns[c].values[row]);
    }
  }
  return out;
}

}  // namespace

TrialRun LiveTrialSession::run(const session::PlannedTrial& planned, const std::string& label) {
  // A recording has each number once: a trial that runs again gets the next one.
  session::PlannedTrial numbered = planned;
  last_number_ = std::max(planned.trial.number, last_number_ + 1);
  numbered.trial.number = last_number_;
  const session::TrialOutcome& outcome = trials_.run(numbered);
  if (!outcome.completed) {
    throw std::runtime_error("trial " + std::to_string(outcome.planned.trial.number) + " (" +
                             label + ") does not count: " + outcome.aborted);
  }
  TrialRun out;
  out.label = label;
  out.number = outcome.planned.trial.number;
  const bool tracking = planned.trial.phase == TrialPhase::kTracking;
  const Trial& trial = outcome.planned.trial;
  const measurement::SessionRows session = measurement::written_trial(recording_, trial, tracking);
  constexpr auto kEvery = static_cast<std::size_t>(kControlRateHz / kWeightRate_hz);
  for (std::size_t n = 0; n < session.weights.size(); n += kEvery) {
    out.weights.push_back(session.weights[n]);
  }
  out.measured = without_gaps(session.rows, trial);
  out.measured.source = "trial " + label;
  if (tracking) out.metrics = metrics_of(out.measured, planned);
  return out;
}

identification::FeedthroughModel LiveTrialSession::identify(const TrialRun& /*pegged*/) {
  return trials_.model();  // the identification's process has given it to the canceller already
}

std::string LiveTrialSession::use(const cancellation::ControlModel& model) {
  return trials_.use(model);
}

void judge_cancellation(const std::filesystem::path& recording,
                        const std::vector<session::TrialOutcome>& outcomes,
                        const std::optional<session::AnswerConfigs>& answers, LoopResult& result) {
  const session::SessionResult session = session::evaluate(recording.string(), outcomes, answers);
  const auto add = [&](TrialRun& run) {
    const auto trial = std::ranges::find(session.trials, run.number, &session::TrialResult::number);
    if (trial == session.trials.end()) return;
    run.cancelled_share = trial->cancelled_share;
    run.counterforce_delay_s = trial->counterforce_delay_s;
    run.forces = trial->forces;
    run.budget = trial->budget;
  };
  for (TrialRun& run : result.trials) add(run);
  for (Round& round : result.rounds) add(round.trial);
}

}  // namespace stillhand::close_the_loop
