// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/session/session.hpp"

#include "services/core/cancellation/model_check.hpp"
#include "services/core/signal/reference.hpp"
#include "services/files/rig/sealed_file.hpp"

namespace stillhand::close_the_loop {
namespace {

constexpr Tick kKeepEvery = 10;  // the paper records at 100 Hz

// What the rig's truth and the screen say of a tracking trial.
void judge(const session::TrialSignals& signals, const session::PlannedTrial& planned,
           TrialRun& out) {
  constexpr double kRate_hz = kControlRateHz / kKeepEvery;
  out.metrics = metrics_of(signals.tracking, planned);
  out.forces = session::trial_forces(signals, kRate_hz);
  if (!planned.moving) return;
  out.cancelled_share = session::cancelled_share(signals.feedthrough_n, signals.motor_n);
  out.counterforce_delay_s =
      session::counterforce_delay_s(signals.feedthrough_n, signals.motor_n, kRate_hz);
}

// What a tracking or pegged trial leaves, without its recording.
TrialRun run_of(const session::TrialSignals& signals, const session::PlannedTrial& planned,
                const std::string& label) {
  TrialRun out;
  out.label = label;
  out.number = planned.trial.number;
  if (planned.trial.phase == TrialPhase::kTracking) judge(signals, planned, out);
  constexpr auto kEvery = static_cast<std::size_t>(kControlRateHz / kKeepEvery / kWeightRate_hz);
  for (std::size_t n = 0; n < signals.weights.size(); n += kEvery) {
    out.weights.push_back(signals.weights[n]);
  }
  return out;
}

// The size of an effect does not depend on the subject.
rig::SealedEffect effect_of(const SimulatedRig& rig) {
  return {rig.undeclared_effect, rig::RigConfig{}, rig.source};
}

}  // namespace

TrialRun run_alone(const SimulatedRig& rig, std::uint64_t seed,
                   const std::vector<session::PlannedTrial>& trials,
                   const cancellation::ControlModel* model, const std::string& label) {
  session::InProcessLoop loop(rig.configs, seed, kKeepEvery, effect_of(rig));
  if (model != nullptr) {
    require_taken(loop.use_model(*model), "the canceller's model",
                  "one that the canceller accepts");
  }
  for (std::size_t i = 0; i + 1 < trials.size(); ++i) static_cast<void>(loop.run(trials[i]));
  return run_of(loop.run(trials.back()), trials.back(), label);
}

InProcessSession::InProcessSession(const SimulatedRig& rig, std::uint64_t seed)
    : sealed_(rig::sealed_text(effect_of(rig).open(), digest::new_nonce())),
      commitment_(digest::digest_line(sealed_, rig::kSealedFile)),
      loop_(rig.configs, seed, kKeepEvery, effect_of(rig)) {
  loop_.keep_measured();
}

TrialRun InProcessSession::run(const session::PlannedTrial& planned, const std::string& label) {
  session::TrialSignals signals = loop_.run(planned);
  TrialRun out = run_of(signals, planned, label);
  out.measured = std::move(signals.measured);
  out.measured.source = "trial " + label;
  return out;
}

identification::FeedthroughModel InProcessSession::identify(const TrialRun& pegged) {
  identification::Record record;
  record.rate_hz = kControlRateHz;
  record.acceleration_m_s2 = pegged.measured.find("a_y")->values;
  record.force_n = pegged.measured.find("f")->values;
  const identification::FeedthroughModel model = identification::identify(record);
  require_taken(loop_.use_model(model), "identification",
                "a model that the canceller takes; a longer --identify-seconds helps");
  return model;
}

std::string InProcessSession::use(const cancellation::ControlModel& model) {
  const auto refusal = loop_.use_model(model);
  return refusal == cancellation::Refusal::kNone ? std::string()
                                                 : std::string(cancellation::describe(refusal));
}

identification::TrackingMetrics metrics_of(const identification::TrackingRecord& record,
                                           const session::PlannedTrial& planned) {
  const double duration_s = static_cast<double>(planned.trial.duration_ticks) * kControlPeriod_s;
  return identification::tracking_metrics(record, signal::reference_design(duration_s));
}

identification::TrackingMetrics metrics_of(const recording::Recording& measured,
                                           const session::PlannedTrial& planned) {
  identification::TrackingRecord record;
  record.rate_hz = kControlRateHz;
  record.target_m = measured.find("x_r")->values;
  record.cursor_m = measured.find("x_p")->values;
  return metrics_of(record, planned);
}

}  // namespace stillhand::close_the_loop
