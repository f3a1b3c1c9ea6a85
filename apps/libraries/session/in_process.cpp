// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/in_process.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "services/core/rig/plant.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::session {
namespace {

CoreConfigs seeded(CoreConfigs configs, std::uint64_t seed) {
  configs.rig = rig::seeded(configs.rig, seed);
  configs.human_operator.seed = configs.rig.seed;
  return configs;
}

// The signals of a recorded trial; README, "The table of a trial".
recording::Recording empty_table(TrialPhase phase) {
  recording::Recording rows;
  rows.rate_hz = kControlRateHz;
  rows.columns = {{"a_x", "m/s^2", {}}, {"a_y", "m/s^2", {}}, {"a_z", "m/s^2", {}},
                  {"roll", "rad", {}},  {"theta", "rad", {}}, {"omega", "rad/s", {}},
                  {"f", "N", {}},       {"f_motor", "N", {}}};
  if (phase == TrialPhase::kTracking) {
    rows.columns.push_back({"x_r", "m", {}});
    rows.columns.push_back({"x_p", "m", {}});
  }
  return rows;
}

}  // namespace

double cancelled_share(const std::vector<double>& feedthrough_n,
                       const std::vector<double>& motor_n) {
  double left = 0.0;
  double all = 0.0;
  for (std::size_t n = 0; n < feedthrough_n.size(); ++n) {
    left += (feedthrough_n[n] + motor_n[n]) * (feedthrough_n[n] + motor_n[n]);
    all += feedthrough_n[n] * feedthrough_n[n];
  }
  return 1.0 - std::sqrt(left / all);
}

double counterforce_delay_s(const std::vector<double>& feedthrough_n, std::vector<double> motor_n,
                            double rate_hz) {
  constexpr double kSegment_s = 4.0;
  constexpr double kLow_hz = 0.5;
  constexpr double kHigh_hz = 4.0;
  for (double& force : motor_n) force = -force;
  const auto segment = static_cast<std::size_t>(kSegment_s * rate_hz);
  const auto spectra = signal::cross_spectra(feedthrough_n, motor_n, rate_hz, segment);
  double moment = 0.0;
  double square = 0.0;
  for (std::size_t k = 0; k < spectra.frequency_hz.size(); ++k) {
    const double f = spectra.frequency_hz[k];
    if (f < kLow_hz || f > kHigh_hz) continue;
    const double weight = std::abs(spectra.s_xy[k]);
    moment -= weight * f * std::arg(spectra.s_xy[k]);
    square += weight * f * f;
  }
  return moment / (2.0 * std::numbers::pi * square);
}

InProcessLoop::InProcessLoop(const CoreConfigs& configs, std::uint64_t seed, Tick keep_every,
                             rig::SealedEffect effect)
    : configs_(seeded(configs, seed)),
      loop_(configs_.rig, configs_.sensing, std::move(effect)),
      motion_(configs_.motion),
      countermeasure_(configs_.cancellation, {.force = true}),
      display_(configs_.display),
      operator_(configs_.human_operator),
      command_filter_(configs_.command_filter),
      keep_every_(keep_every) {}

cancellation::Refusal InProcessLoop::use_model(const identification::FeedthroughModel& model) {
  const bool fit = configs_.cancellation.sampling.model_ticks > 1;
  return countermeasure_.load_model(cancellation::control_model(fit ? model.fit : model.control));
}

cancellation::Refusal InProcessLoop::use_model(const cancellation::ControlModel& model) {
  return countermeasure_.load_model(model);
}

void InProcessLoop::arm(const PlannedTrial& planned) {
  motion_.arm(motion::MotionTrajectory(motion_profile(planned), configs_.motion.limits),
              planned.trial);
  if (planned.trial.phase == TrialPhase::kTracking) {
    display_.arm(planned.trial, planned.reference_seed);
  } else {
    display_.disarm();
  }
  operator_.arm(planned.trial);
}

TrialSignals InProcessLoop::run(PlannedTrial planned) {
  planned.trial.start_tick = tick_ + planned.trial.ramp_ticks + 1;
  arm(planned);
  TrialSignals signals;
  signals.pegged.rate_hz = kControlRateHz;
  if (keeps_measured_) signals.measured = empty_table(planned.trial.phase);
  signals.tracking.rate_hz = kControlRateHz / static_cast<double>(keep_every_);
  while (tick_ <
         planned.trial.start_tick + planned.trial.duration_ticks + planned.trial.ramp_ticks) {
    tick_once(planned, signals);
  }
  return signals;
}

void InProcessLoop::tick_once(const PlannedTrial& planned, TrialSignals& signals) {
  const Tick tick = ++tick_;
  const bool covered = planned.trial.covers(tick);
  const bool tracking = covered && planned.trial.phase == TrialPhase::kTracking;

  cancellation::CountermeasureOutput cancelled{};
  const auto [sensed, truth] = loop_.turn(
      tick,
      {.command = motion_.step(tick),
       .operator_force_n = operator_force_n_,
       .pegged = covered && planned.trial.phase == TrialPhase::kPegged,
       .permitted = covered},
      [&](const sensing::Sensed& sample) {
        cancelled =
            countermeasure_.step(input_of(tick, sample, planned.cancellation && tracking, covered));
        return cancelled.force_n;
      });
  const double command_rad =
      planned.command_filter ? command_filter_.step(sensed.theta_rad, cancelled.predicted_force_n)
                             : sensed.theta_rad;
  const display::TrackingSample shown = display_.step({tick, command_rad});
  operator_force_n_ =
      operator_.step({tick, shown.target_m, shown.cursor_m, tracking, sensed.accel_y_m_s2}).force_n;
  if (planned.trial.measures(tick)) {
    keep(planned, sensed, truth, cancelled, shown, signals);
  }
}

void InProcessLoop::keep(const PlannedTrial& planned, const sensing::Sensed& sensed,
                         const rig::RigTruth& truth,
                         const cancellation::CountermeasureOutput& cancelled,
                         const display::TrackingSample& shown, TrialSignals& signals) const {
  if (planned.trial.phase == TrialPhase::kPegged) {
    signals.pegged.acceleration_m_s2.push_back(sensed.accel_y_m_s2);
    signals.pegged.force_n.push_back(sensed.force_n);
  }
  if (keeps_measured_) keep_row(sensed, shown, signals.measured);
  if ((tick_ - planned.trial.start_tick) % keep_every_ != 0) return;
  if (planned.trial.phase == TrialPhase::kTracking) {
    signals.tracking.target_m.push_back(shown.target_m);
    signals.tracking.cursor_m.push_back(shown.cursor_m);
  }
  signals.feedthrough_n.push_back(truth.feedthrough_force_n);
  signals.motor_n.push_back(truth.motor_force_n);
  signals.volitional_n.push_back(truth.volitional_force_n);
  signals.hand_m_s.push_back(configs_.rig.stick.lever_m * truth.omega_rad_s);
  signals.weights.push_back(cancelled.weights);
}

void InProcessLoop::keep_row(const sensing::Sensed& sensed, const display::TrackingSample& shown,
                             recording::Recording& rows) const {
  const std::array<double, 10> row{sensed.accel_x_m_s2, sensed.accel_y_m_s2,   sensed.accel_z_m_s2,
                                   sensed.roll_rad,     sensed.theta_rad,      sensed.omega_rad_s,
                                   sensed.force_n,      loop_.motor_force_n(), shown.target_m,
                                   shown.cursor_m};
  rows.time_s.push_back(static_cast<double>(tick_) / kControlRateHz);
  for (std::size_t i = 0; i < rows.columns.size(); ++i) rows.columns[i].values.push_back(row[i]);
}

}  // namespace stillhand::session
