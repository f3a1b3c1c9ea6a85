// SPDX-License-Identifier: Apache-2.0
#include "closed_loop/session.hpp"

#include "rig/sealed_file.hpp"
#include "signal/reference.hpp"

namespace stillhand::closed_loop {
namespace {

constexpr Tick kKeepEvery = 10;  // the paper records at 100 Hz

}  // namespace

InProcessSession::InProcessSession(const experiment::CoreConfigs& configs, std::uint64_t seed,
                                   std::uint64_t undeclared_effect)
    : sealed_(rig::sealed_text(rig::SealedEffect(undeclared_effect, configs.rig).open(),
                               rig::new_nonce())),
      commitment_(rig::digest_line(sealed_, rig::kSealedFile)),
      loop_(configs, seed, kKeepEvery, rig::SealedEffect(undeclared_effect, configs.rig)) {
  loop_.keep_measured();
}

TrialRun InProcessSession::run(const experiment::PlannedTrial& planned, const std::string& label) {
  experiment::TrialSignals signals = loop_.run(planned);
  TrialRun out;
  out.label = label;
  out.measured = std::move(signals.measured);
  out.measured.source = "trial " + label;
  if (planned.trial.phase == TrialPhase::kTracking) {
    const double duration_s = static_cast<double>(planned.trial.duration_ticks) * kControlPeriod_s;
    out.metrics =
        identification::tracking_metrics(signals.tracking, signal::reference_design(duration_s));
    if (planned.moving) {
      out.cancelled_share = experiment::cancelled_share(signals.feedthrough_n, signals.motor_n);
    }
  }
  out.weights = loop_.weights();
  return out;
}

cancellation::Refusal InProcessSession::use(const cancellation::AugmentedModel& model) {
  return loop_.use_model(model);
}

std::string InProcessSession::open_effect() { return sealed_; }

}  // namespace stillhand::closed_loop
