// SPDX-License-Identifier: Apache-2.0
#include "services/processes/identification/shell.hpp"

#include "services/messages/identification/codec.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::identification {

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
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  service_.note_tick(sensed.tick());
  newest_tick_.store(sensed.tick(), std::memory_order_relaxed);
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
