// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/on_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/libraries/session/core/trial_forces.hpp"
#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/measured_ticks.hpp"
#include "services/core/rig/parts/sensors.hpp"
#include "services/core/signal/moments.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/sensing/codec.hpp"

namespace stillhand::session {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

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

/// The sample with the platform's true acceleration along the rolled axis (RG-23), without noise
/// and steps of the acquisition.
sensing::DeviceSample noiseless(sensing::DeviceSample sample, double accel_m_s2,
                                const sensing::Config& sensing) noexcept {
  if (std::isnan(accel_m_s2)) return sample;
  const double along_m_s2 =
      accel_m_s2 * std::cos(sample.roll_rad) - kGravity_m_s2 * std::sin(sample.roll_rad);
  sample.accel_y_v = along_m_s2 * sensing.accel_sensitivity_v_m_s2 + sensing.accel_y_offset_v;
  return sample;
}

/// First tick of what a trial needs: the model settles before it.
Tick first_tick(const Trial& trial, const OnTime& on_time) {
  return trial.start_tick - trial.ramp_ticks - on_time.unsettled_ticks();
}

struct Answered {
  Tick tick_ = 0;
  OnTime::Answer answer;

  [[nodiscard]] Tick tick() const noexcept { return tick_; }
};

/// Every raw sample of the trial, and before it, answered in its tick.
std::vector<Answered> answers_to(const SessionRecording& session, const Trial& trial,
                                 OnTime on_time) {
  const Tick first = first_tick(trial, on_time);
  std::vector<Answered> answers;
  auto truth = session.rig_truths.begin();
  for (const auto& raw : session.raw_samples) {
    if (raw.tick() < first || raw.tick() >= trial.start_tick + trial.duration_ticks) continue;
    while (truth != session.rig_truths.end() && truth->tick() < raw.tick()) ++truth;
    const bool known = truth != session.rig_truths.end() && truth->tick() == raw.tick();
    answers.push_back(
        {raw.tick(), on_time.step(sensing::from_idl(raw),
                                  known ? truth->platform_acceleration_m_s2() : kUnknown,
                                  trial.covers(raw.tick()))});
  }
  return answers;
}

std::vector<TickForces> forces_of(const SessionRecording& session, const Trial& trial,
                                  const std::vector<Answered>& answers) {
  const auto truth = [&](auto value) { return measured(session.rig_truths, trial, value); };
  const auto asked = [&](auto of) {
    return measured(answers, trial, [of](const Answered& each) { return each.answer.forces.*of; });
  };
  const auto feedthrough_n = truth([](const auto& t) { return t.feedthrough_force_n(); });
  const auto motor_n = truth([](const auto& t) { return t.motor_force_n(); });
  const auto on_time_n = asked(&AskedForces::on_time_n);
  const auto unlimited_n = asked(&AskedForces::unlimited_n);
  const auto noiseless_n = asked(&AskedForces::noiseless_n);
  std::vector<TickForces> forces;
  for (std::size_t n = 0; n < motor_n.size(); ++n) {
    forces.push_back(
        {feedthrough_n[n], motor_n[n], {on_time_n[n], unlimited_n[n], noiseless_n[n]}});
  }
  return forces;
}

/// Median of what the recorded values differ by from those of the answers, as a share of their RMS;
/// a median, since lost samples change some.
template <typename Message, typename Recorded, typename Of>
double apart(const std::vector<Message>& messages, const Trial& trial,
             const std::vector<Answered>& answers, Recorded recorded, Of of) {
  std::vector<double> values, differ;
  auto answer = answers.begin();
  for (const Message& message : messages) {
    if (!trial.measures(message.tick())) continue;
    while (answer != answers.end() && answer->tick() < message.tick()) ++answer;
    if (answer == answers.end() || answer->tick() != message.tick()) continue;
    values.push_back(recorded(message));
    differ.push_back(std::abs(values.back() - of(answer->answer)));
  }
  const double whole = rms(values);
  return whole > 0.0 ? signal::middle_of(std::move(differ)) / whole : 0.0;
}

/// The settings are not those of the session: of its canceller or its sensors, or, since a command
/// that is late by some ticks differs by some hundredths, of its motor and the force's limits.
std::string why_other_settings(const SessionRecording& session, const Trial& trial,
                               const std::vector<Answered>& answers) {
  constexpr double kMostPredicted = 0.01;
  constexpr double kMostForce = 0.1;
  const double predicted = apart(
      session.motor_commands, trial, answers,
      [](const auto& command) { return command.predicted_force_n(); },
      [](const OnTime::Answer& answer) { return answer.predicted_n; });
  const double force = apart(
      session.rig_truths, trial, answers, [](const auto& truth) { return truth.motor_force_n(); },
      [](const OnTime::Answer& answer) { return answer.forces.on_time_n; });
  const bool of_the_canceller = predicted > kMostPredicted;
  if (!of_the_canceller && force <= kMostForce) return {};
  return fmt::format(
      "the settings are not those of the session: half of {} {:.0f} % or more apart from the "
      "recorded ones",
      of_the_canceller ? "the canceller's predictions are" : "the motor's forces are",
      100.0 * (of_the_canceller ? predicted : force));
}

/// Lateral acceleration, and other channels that move by more than a hundredth of it.
std::vector<std::vector<double>> motion_of(const SessionRecording& session, const Trial& trial) {
  constexpr double kMoves = 0.01;
  const auto sensed = [&](auto value) { return measured(session.sensed, trial, value); };
  std::vector<std::vector<double>> channels{measured(
      session.rig_truths, trial, [](const auto& t) { return t.platform_acceleration_m_s2(); })};
  const double least_m_s2 = kMoves * rms(channels.front());
  for (std::vector<double> other :
       {sensed([](const auto& s) { return s.accel_x_m_s2(); }),
        sensed([](const auto& s) { return s.accel_z_m_s2() - kGravity_m_s2; }),
        sensed([](const auto& s) { return kGravity_m_s2 * s.roll_rad(); })}) {
    if (rms(other) > least_m_s2) channels.push_back(std::move(other));
  }
  return channels;
}

/// Of a rig of devices nobody does.
bool knows_the_feedthrough(const SessionRecording& session, const Trial& trial) {
  return std::ranges::any_of(session.rig_truths, [&](const auto& truth) {
    return trial.measures(truth.tick()) && std::isfinite(truth.feedthrough_force_n());
  });
}

}  // namespace

OnTime::Chain::Chain(const AnswerConfigs& configs, bool answers_in_tick)
    : conditioner(configs.sensing),
      canceller(configs.cancellation, {.force = true}),
      motor(configs.motor, configs.lever_m),
      in_tick(answers_in_tick) {}

void OnTime::Chain::step(const sensing::DeviceSample& sample, bool cancels) noexcept {
  const sensing::Sensed sensed = conditioner.step(sample);
  const auto answer = canceller.step(input_of(sample.tick, sensed, cancels, cancels));
  const double before_n = std::exchange(command_n, answer.force_n);
  predicted_n = answer.predicted_force_n;
  motor_n = motor.step({true, 0, in_tick ? command_n : before_n, cancels}).force_n;
}

OnTime::OnTime(const AnswerConfigs& configs)
    : sensing_(configs.sensing),
      sensed_(configs, configs.motor.answers_in_tick()),
      unlimited_(without_limits(configs), configs.motor.answers_in_tick()),
      noiseless_(unlimited_) {}

bool OnTime::load_model(const cancellation::ControlModel& model) {
  const auto loads = [&](Chain& chain) {
    return chain.canceller.load_model(model) == cancellation::Refusal::kNone;
  };
  return loads(sensed_) && loads(unlimited_) && loads(noiseless_);
}

OnTime::Answer OnTime::step(const sensing::DeviceSample& sample, double accel_m_s2,
                            bool cancels) noexcept {
  sensed_.step(sample, cancels);
  unlimited_.step(sample, cancels);
  noiseless_.step(noiseless(sample, accel_m_s2, sensing_), cancels);
  return {{sensed_.motor_n, unlimited_.motor_n, noiseless_.motor_n}, sensed_.predicted_n};
}

std::optional<std::int32_t> model_in_use(const SessionRecording& session, const Trial& trial) {
  const auto first = std::ranges::find_if(session.motor_commands, [&](const auto& command) {
    return trial.measures(command.tick()) && command.model() >= 0;
  });
  if (first == session.motor_commands.end()) return std::nullopt;
  return first->model();
}

namespace {

// Ticks without a sample, where the file itself has lost some: nobody knows which of them the rig
// had sent.
std::int64_t not_recorded(const SessionRecording& session, const Trial& trial) {
  if (session.damage.empty()) return 0;
  const auto in_trial = [&](const auto& sample) { return trial.measures(sample.tick()); };
  return trial.duration_ticks - std::ranges::count_if(session.raw_samples, in_trial);
}

}  // namespace

SplitTrial split_trial(const SessionRecording& session, const Trial& trial,
                       const AnswerConfigs& configs) {
  if (!knows_the_feedthrough(session, trial)) {
    return {.why = "nobody knows the feedthrough force of a rig of devices"};
  }
  if (const std::int64_t ticks = not_recorded(session, trial); ticks > 0) {
    return {.why =
                fmt::format("{:.3g} s of it are lost with damaged parts of the file, and whether "
                            "they came late is not known",
                            static_cast<double>(ticks) / kControlRateHz)};
  }
  const auto number = model_in_use(session, trial);
  const auto model =
      number ? model_of(session, *number, configs.cancellation.sampling) : std::nullopt;
  OnTime on_time(configs);
  if (!model || !on_time.load_model(*model)) {
    return {.why = "the recording lacks the model that the motor followed"};
  }
  const std::vector<Answered> answers = answers_to(session, trial, std::move(on_time));
  if (std::string why = why_other_settings(session, trial, answers); !why.empty()) {
    return {.why = std::move(why)};
  }
  SplitTrial split{force_budget({forces_of(session, trial, answers), motion_of(session, trial)}),
                   ""};
  if (!split.budget) {
    split.why = "it takes 12 s of whole samples";
  }
  return split;
}

}  // namespace stillhand::session
