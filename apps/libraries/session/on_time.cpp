// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/on_time.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apps/libraries/session/core/trial_forces.hpp"
#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/measured_ticks.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/rig/sensors.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/sensing/codec.hpp"

namespace stillhand::session {
namespace {

struct Answer {
  Tick tick_ = 0;
  double motor_n = 0.0;

  [[nodiscard]] Tick tick() const noexcept { return tick_; }
};

std::optional<cancellation::ControlModel> model_of(const SessionRecording& session,
                                                   std::int32_t number,
                                                   const cancellation::SamplingConfig& sampling) {
  const auto numbered = [number](const auto& each) { return each.model() == number; };
  if (number >= cancellation::kFirstControlModel) {
    const auto model = std::ranges::find_if(session.control_models, numbered);
    if (model == session.control_models.end()) return std::nullopt;
    return cancellation::from_idl(*model);
  }
  const auto model = std::ranges::find_if(session.models, numbered);
  if (model == session.models.end()) return std::nullopt;
  return cancellation::control_model(cancellation::from_idl(*model, sampling));
}

/// No limit that a model's force reaches: the ends of their ranges.
AnswerConfigs without_limits(AnswerConfigs configs) {
  const signal::ForceLimits none{.max_force_n = 60.0, .max_slew_n_s = 20000.0};
  configs.cancellation.limits = none;
  configs.motor.limits = none;
  configs.motor.current_limit_a = 40.0;
  return configs;
}

/// First tick of what a trial needs: the model settles before it.
Tick first_tick(const Trial& trial, const cancellation::ControlModel& model,
                const AnswerConfigs& configs) {
  cancellation::Countermeasure canceller(configs.cancellation, {.force = true});
  if (canceller.load_model(model) != cancellation::Refusal::kNone) return trial.start_tick;
  return trial.start_tick - trial.ramp_ticks - canceller.unsettled_ticks();
}

/// The motor's force in every tick of the samples.
std::vector<Answer> answers_to(const std::vector<sensing::DeviceSample>& samples,
                               const PlannedTrial& planned, const cancellation::ControlModel& model,
                               const AnswerConfigs& configs) {
  const Trial& trial = planned.trial;
  sensing::Conditioner conditioner(configs.sensing);
  cancellation::Countermeasure canceller(configs.cancellation, {.force = true});
  rig::Motor motor(configs.motor, configs.lever_m);
  if (canceller.load_model(model) != cancellation::Refusal::kNone) return {};
  std::vector<Answer> answers;
  double command_n = 0.0;
  for (const sensing::DeviceSample& sample : samples) {
    const bool covered = trial.covers(sample.tick);
    const sensing::Sensed sensed = conditioner.step(sample);
    const double before_n = std::exchange(
        command_n, canceller.step(input_of(sample.tick, sensed, covered, covered)).force_n);
    const double demand_n = configs.motor.answers_in_tick() ? command_n : before_n;
    answers.push_back({sample.tick, motor.step({true, 0, demand_n, covered}).force_n});
  }
  return answers;
}

std::vector<double> over_trial(const std::vector<Answer>& answers, const Trial& trial) {
  std::int64_t missing = 0;
  if (answers.empty()) return {};
  return measured(answers, trial, [](const Answer& each) { return each.motor_n; }, missing);
}

/// The samples with the platform's true acceleration along the rolled axis (RG-23), without noise
/// and steps of the acquisition.
std::vector<sensing::DeviceSample> noiseless(std::vector<sensing::DeviceSample> samples,
                                             const SessionRecording& session,
                                             const sensing::Config& sensing) {
  auto truth = session.rig_truths.begin();
  for (sensing::DeviceSample& sample : samples) {
    while (truth != session.rig_truths.end() && truth->tick() < sample.tick) ++truth;
    if (truth == session.rig_truths.end() || truth->tick() != sample.tick) continue;
    const double along_m_s2 = truth->platform_acceleration_m_s2() * std::cos(sample.roll_rad) -
                              rig::kGravity_m_s2 * std::sin(sample.roll_rad);
    sample.accel_y_v = along_m_s2 * sensing.accel_sensitivity_v_m_s2 + sensing.accel_y_offset_v;
  }
  return samples;
}

/// Lateral acceleration, and other channels that move by more than a hundredth of it.
std::vector<std::vector<double>> motion_of(const SessionRecording& session, const Trial& trial) {
  constexpr double kMoves = 0.01;
  std::int64_t missing = 0;
  const auto sensed = [&](auto value) { return measured(session.sensed, trial, value, missing); };
  std::vector<std::vector<double>> channels{measured(
      session.rig_truths, trial, [](const auto& t) { return t.platform_acceleration_m_s2(); },
      missing)};
  const double least_m_s2 = kMoves * rms(channels.front());
  for (std::vector<double> other :
       {sensed([](const auto& s) { return s.accel_x_m_s2(); }),
        sensed([](const auto& s) { return s.accel_z_m_s2() - rig::kGravity_m_s2; }),
        sensed([](const auto& s) { return rig::kGravity_m_s2 * s.roll_rad(); })}) {
    if (rms(other) > least_m_s2) channels.push_back(std::move(other));
  }
  return channels;
}

}  // namespace

BudgetSignals on_time_signals(const SessionRecording& session, const PlannedTrial& planned,
                              std::int32_t number, const AnswerConfigs& configs) {
  const Trial& trial = planned.trial;
  const auto model = model_of(session, number, configs.cancellation.sampling);
  std::int64_t missing = 0;
  const auto truth = [&](auto value) {
    return measured(session.rig_truths, trial, value, missing);
  };
  std::vector<double> feedthrough_n = truth([](const auto& t) { return t.feedthrough_force_n(); });
  const bool known = std::ranges::all_of(feedthrough_n, [](double n) { return std::isfinite(n); });
  if (!model || !known) return {};
  const Tick first = first_tick(trial, *model, configs);
  std::vector<sensing::DeviceSample> samples;
  for (const auto& raw : session.raw_samples) {
    if (raw.tick() >= first && raw.tick() < trial.start_tick + trial.duration_ticks) {
      samples.push_back(sensing::from_idl(raw));
    }
  }
  const AnswerConfigs free = without_limits(configs);
  const auto asked = [&](const std::vector<sensing::DeviceSample>& of, const AnswerConfigs& with) {
    return over_trial(answers_to(of, planned, *model, with), trial);
  };
  return {std::move(feedthrough_n),
          truth([](const auto& t) { return t.motor_force_n(); }),
          {asked(samples, configs), asked(samples, free),
           asked(noiseless(samples, session, configs.sensing), free)},
          motion_of(session, trial)};
}

}  // namespace stillhand::session
