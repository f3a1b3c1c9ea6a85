// SPDX-License-Identifier: Apache-2.0
#include "services/processes/identification/shell.hpp"

#include <cstdio>

#include "services/core/contract/flag.hpp"
#include "services/messages/identification/codec.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::identification {
namespace {

// The motor does not do what the model asks for.
constexpr Flags kUnsound =
    kInputInvalid | kInputStale | kInhibited | kNoModel | kRampingDown | kFault;

}  // namespace

Shell::Shell(runtime::Service& service)
    : service_(service),
      config_(service.config<Config>()),
      model_(service.bus().publisher<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel)) {
  service.on_trial([this](const Trial& trial, const auto&) {
    if (trial.phase == TrialPhase::kPegged || trial.phase == TrialPhase::kFree) {
      phase_ = trial.phase;
      pegged_.begin(trial);
    }
    service_.note_armed(trial.number);
  });
  if (config_.false_alarms_h > 0.0) watch_.emplace(config_.false_alarms_h);
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
  service.bus().subscribe<stillhand_msgs::MotorCommand>(
      topics::kMotorCommand, [this](const auto& message, const auto&) { on_command(message); });
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  service_.note_tick(sensed.tick());
  newest_tick_.store(sensed.tick(), std::memory_order_relaxed);
  if (sensed.tick() >= 0) {
    angles_[static_cast<std::size_t>(sensed.tick()) % angles_.size()] = {sensed.tick(),
                                                                         sensed.theta_rad()};
  }
  const double moved =
      phase_ == TrialPhase::kFree ? displacement_m(sensed.theta_rad()) : sensed.force_n();
  if (!pegged_.take(sensed.tick(), sensed.accel_y_m_s2(), moved)) return;
  {
    const std::lock_guard lock(mutex_);
    finished_ = pegged_.release();
    finished_phase_ = phase_;
  }
  wake_.notify_all();
}

void Shell::on_command(const stillhand_msgs::MotorCommand& command) {
  if (!watch_ || command.tick() < 0) return;
  const Angle& angle = angles_[static_cast<std::size_t>(command.tick()) % angles_.size()];
  if (angle.tick != command.tick()) return;  // lost, or later than its answer
  const Trial& trial = service_.trial();
  const bool acts = trial.phase == TrialPhase::kTracking && trial.measures(command.tick()) &&
                    command.enabled() && command.permitted() && command.mitigated_trial() == 0 &&
                    (command.flags() & kUnsound) == 0;
  const auto change =
      watch_->step({command.tick(), command.model(), acts, command.predicted_force_n(),
                    -command.force_n(), angle.theta_rad});
  if (!change) return;
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "by %.0f %% of the predicted force",
                100.0 * change->share);
  constexpr double kTick_us = 1e6 * kControlPeriod_s;
  const Tick ago = newest_tick_.load(std::memory_order_relaxed) - change->since;
  service_.note_event(stillhand_msgs::EVENT_NOTE, text.data(), kTick_us * static_cast<double>(ago),
                      stillhand_msgs::CODE_MODEL_CHANGED);
}

void Shell::run() {
  std::jthread fitting([this](const std::stop_token& stop) { fit_trials(stop); });
  service_.run();
}

void Shell::fit_trials(const std::stop_token& stop) {
  runtime::become_background();
  for (;;) {
    PeggedTrial trial;
    TrialPhase phase = TrialPhase::kPegged;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return finished_.has_value(); })) return;
      trial = std::move(*finished_);
      phase = finished_phase_;
      finished_.reset();
    }
    auto message = fit(trial, phase);
    message.from_tick(newest_tick_.load(std::memory_order_relaxed) + kModelNotice_ticks);
    model_.write(message);
  }
}

stillhand_msgs::FeedthroughModel Shell::fit(const PeggedTrial& trial, TrialPhase phase) {
  const runtime::OrdinaryWhile ordinary;
  const auto number = static_cast<std::int32_t>(trial.number);
  if (phase != TrialPhase::kFree) return to_idl(identify(trial, config_), models_++, number);
  auto message = to_idl(identify_position(trial, config_), models_++, number);
  message.to_position(true);
  return message;
}

}  // namespace stillhand::identification
