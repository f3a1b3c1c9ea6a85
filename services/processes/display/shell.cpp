// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/shell.hpp"

#include "services/core/contract/config_error.hpp"

namespace stillhand::display {

Shell::Shell(runtime::Service& service)
    : service_(service),
      config_(service.config<TrackingDisplay::Config>()),
      core_(config_),
      tracking_(service.bus().publisher<stillhand_msgs::TrackingSample>(topics::kTrackingSample)),
      answers_(service.bus().publisher<stillhand_msgs::Answer>(topics::kAnswer)),
      emergency_stop_(service.bus(), "Escape on the tracking screen") {
  service.on_trial([this](const Trial& trial, const stillhand_msgs::TrialControl& message) {
    paused_ = message.session() == stillhand_msgs::SESSION_PAUSED;
    core_.postpone(trial);
    if (trial.number >= 0) prepare(trial, message.reference_seed());
  });
  // The catalogue gives the display the others' status; a stale picture shows by its tick.
  service.bus().subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                                         [](const auto&, const auto&) {});
  // Texts of bounded length: copying one does not allocate.
  service.bus().subscribe<stillhand_msgs::Prompt>(
      topics::kPrompt, [this](const auto& message, const auto&) { prompt_.store(message); });
  service.bus().subscribe<stillhand_msgs::MotorCommand>(
      topics::kMotorCommand,
      [this](const auto& message, const auto&) { taken_off_.offer(from_idl(message)); });
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

void Shell::stop_at_once() { emergency_stop_.ask(); }

void Shell::answer(const Answering::Answer& answer) {
  auto message = to_idl(answer);
  answers_.write(message);
}

void Shell::prepare(const Trial& trial, std::uint64_t reference_seed) {
  handover_.prepare([this, trial, reference_seed]() -> std::unique_ptr<Prepared> {
    try {
      auto prepared = std::make_unique<Prepared>(Prepared{std::nullopt, trial});
      if (trial.phase == TrialPhase::kTracking) {
        prepared->reference = reference_on_screen(config_, trial.duration_ticks, reference_seed);
      }
      return prepared;
    } catch (const ConfigError& error) {
      service_.note_event(stillhand_msgs::EVENT_NOTE, error.what());
      return nullptr;  // the trial is never armed, and so never begins
    }
  });
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  if (Prepared* newest = handover_.current(); newest != nullptr && newest != armed_) {
    armed_ = newest;
    if (newest->reference) {
      core_.arm(std::move(*newest->reference), newest->trial);
    } else {
      core_.disarm();
    }
    service_.note_armed(newest->trial.number);
  }
  const TakenOff off = taken_off_.at(sensed.tick());
  const TrackingSample sample = core_.step(from_idl(sensed, off));
  auto message =
      to_idl(sample, sensed.tick(), armed_ == nullptr ? -1 : armed_->trial.number, off.tick);
  tracking_.write(message);
  shown_.store({sensed.tick(), sample, service_.trial(), paused_});
  service_.note_tick(sensed.tick());
}

}  // namespace stillhand::display
