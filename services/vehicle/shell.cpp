// SPDX-License-Identifier: Apache-2.0
#include "services/vehicle/shell.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "services/contract/config_error.hpp"
#include "services/motion/codec.hpp"
#include "services/vehicle/codec.hpp"

namespace stillhand::vehicle {

Shell::Shell(runtime::Service& service, const DrivenConfig& config)
    : service_(service),
      config_(config),
      core_(config_),
      command_(service.bus().publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand)) {
  service.on_trial([this](const Trial& trial, const auto&) {
    // Another trial, or none: what moves the platform is over, ended or not.
    if (armed_ != trial.number) core_.disarm();
    prepare_when_complete();
  });
  service.bus().subscribe<stillhand_msgs::TrialAssignment>(
      topics::kTrialAssignment, [this](const auto& message, const auto&) {
        assignment_ = message;
        prepare_when_complete();
      });
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

// Control and assignment come in either order.
void Shell::prepare_when_complete() {
  const Trial trial = service_.trial();
  if (!assignment_ || trial.number < 0 || assignment_->trial() != trial.number ||
      prepared_trial_ == trial.number) {
    return;
  }
  prepared_trial_ = trial.number;
  const bool by_stick = driven(*assignment_, trial);
  const motion::MotionProfile profile = motion::from_idl(*assignment_, trial);
  handover_.prepare([this, profile, trial, by_stick]() -> std::unique_ptr<Prepared> {
    try {
      auto prepared = std::make_unique<Prepared>();
      prepared->trial = trial;
      prepared->driven = by_stick;
      if (!by_stick) prepared->trajectory = motion::MotionTrajectory(profile, config_.limits);
      return prepared;
    } catch (const ConfigError& error) {
      service_.note_event(stillhand_msgs::EVENT_NOTE, error.what());
      return nullptr;  // the platform stands still and the trial is never armed
    }
  });
}

void Shell::on_sensed(const stillhand_msgs::Sensed& message) {
  const StickSample sample = from_idl(message);
  if (Prepared* newest = handover_.current(); newest != nullptr &&
                                              newest->trial.number == service_.trial().number &&
                                              newest->trial.number != armed_) {
    armed_ = newest->trial.number;
    core_.arm(std::move(newest->trajectory), newest->trial, newest->driven);
    service_.note_armed(armed_);
  }
  // Lost sensed samples leave a gap here: the stick of those ticks is missing.
  const Tick first = std::max(last_ + 1, sample.tick + 1);
  for (Tick next = first; next <= sample.tick + kLead_ticks; ++next) {
    StickSample at = sample;
    at.tick = next - kLead_ticks;
    at.sound = sample.sound && at.tick == sample.tick;
    auto command = motion::to_idl(core_.step(at), next, armed_);
    command_.write(command);
    last_ = next;
  }
  if (core_.ended() && ended_trial_ != armed_) report_end();
  service_.note_tick(sample.tick);
}

void Shell::report_end() {
  ended_trial_ = armed_;
  char text[96];
  std::snprintf(text, sizeof(text), "growing oscillation of the stick at %.2f Hz: drive ended",
                core_.oscillation().frequency_hz());
  service_.note_event(stillhand_msgs::EVENT_NOTE, text);
}

}  // namespace stillhand::vehicle
