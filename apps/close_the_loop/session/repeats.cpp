// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/session/repeats.hpp"

#include <algorithm>
#include <string>

#include "services/core/contract/expects.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::close_the_loop {
namespace {

struct Wanted {
  std::string label;
  const cancellation::ControlModel* model;  ///< null: the motor is off
};

// C+ that was not augmented is C'.
std::vector<Wanted> wanted_trials(const LoopResult& result,
                                  const cancellation::ControlModel& paper) {
  const Round& final_round = result.rounds[result.final_round];
  std::vector<Wanted> trials{
      {"A", nullptr}, {"B", nullptr}, {"C", &paper}, {"C'", &result.followed_model}};
  if (final_round.augmented) trials.push_back({"C+", &final_round.model});
  return trials;
}

TrialRun run_one(const Wanted& wanted, session::ProtocolOptions protocol, std::uint64_t repeat,
                 const SimulatedRig& rig) {
  protocol.seed = session::repeat_seed(protocol.seed, repeat);
  const std::vector<session::PlannedTrial> plan = session::plan(protocol);
  const auto cancelled = std::ranges::find_if(plan, &session::PlannedTrial::cancellation);
  STILLHAND_EXPECTS(cancelled != plan.end());
  session::PlannedTrial planned = *cancelled;
  planned.moving = wanted.label != "A";
  planned.cancellation = wanted.model != nullptr;
  return run_alone(rig, protocol.seed, {plan.front(), planned}, wanted.model, wanted.label);
}

}  // namespace

Conditions run_repeats(const LoopResult& result, const session::ProtocolOptions& protocol,
                       const SimulatedRig& rig, const RepeatOptions& options) {
  const auto paper = cancellation::control_model(result.paper_model.control);
  const std::vector<Wanted> trials = wanted_trials(result, paper);
  const auto repeats = static_cast<std::size_t>(options.repeats);
  Conditions out;
  for (const Wanted& each : trials) out[each.label].resize(repeats);
  const std::size_t count = repeats * trials.size();
  const auto job = [&](std::size_t index) {
    const Wanted& wanted = trials[index % trials.size()];
    const std::size_t repeat = index / trials.size();
    out.at(wanted.label)[repeat] = run_one(wanted, protocol, repeat, rig);
  };
  const auto on_done = [&](std::size_t done) {
    return options.progress(static_cast<double>(done) / static_cast<double>(count));
  };
  if (!runtime::run_jobs(count, options.threads, job, on_done)) throw diagnosis::Interrupted();
  if (!out.contains("C+")) {
    out["C+"] = out.at("C'");
    for (TrialRun& run : out["C+"]) run.label = "C+";
  }
  return out;
}

}  // namespace stillhand::close_the_loop
