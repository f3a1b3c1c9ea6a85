// SPDX-License-Identifier: Apache-2.0
#include "services/processes/vehicle/shell.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "services/messages/motion/codec.hpp"
#include "services/messages/vehicle/codec.hpp"

namespace stillhand::vehicle {

Shell::Shell(runtime::Service& service, const DrivenConfig& config)
    : service_(service),
      config_(config),
      core_(config_),
      command_(service.bus().publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand)),
      trial_(
          service,
          [this](const auto& assignment, const auto& trial) { return plan(assignment, trial); },
          [this](const Trial& trial) { core_.announce(trial); }) {
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

motion::AssignedTrial<Shell::Prepared>::Make Shell::plan(
    const stillhand_msgs::TrialAssignment& assignment, const Trial& trial) const {
  const bool by_stick = driven(assignment, trial);
  return [this, profile = motion::from_idl(assignment, trial), trial, by_stick] {
    auto prepared = std::make_unique<Prepared>();
    prepared->trial = trial;
    prepared->driven = by_stick;
    if (by_stick) {
      const std::string text = std::string(kDrivenEvent) + std::to_string(trial.number);
      service_.note_event(stillhand_msgs::EVENT_NOTE, text.c_str());
    } else {
      prepared->trajectory = motion::MotionTrajectory(profile, config_.limits);
    }
    return prepared;
  };
}

void Shell::on_sensed(const stillhand_msgs::Sensed& message) {
  const StickSample sample = from_idl(message);
  if (Prepared* newest = trial_.newly_armed()) {
    core_.arm(std::move(newest->trajectory), newest->trial, newest->driven);
  }
  // Lost sensed samples leave a gap here: the stick of those ticks is missing.
  const Tick first = std::max(last_ + 1, sample.tick + 1);
  for (Tick next = first; next <= sample.tick + kLead_ticks; ++next) {
    StickSample at = sample;
    at.tick = next - kLead_ticks;
    at.sound = sample.sound && at.tick == sample.tick;
    auto command = motion::to_idl(core_.step(at), next, trial_.armed());
    command_.write(command);
    last_ = next;
  }
  if (core_.ended() && ended_trial_ != trial_.armed()) report_end();
  service_.note_tick(sample.tick);
}

void Shell::report_end() {
  ended_trial_ = trial_.armed();
  char text[96];
  std::snprintf(text, sizeof(text), "growing oscillation of the stick at %.2f Hz: drive ended",
                core_.oscillation().frequency_hz());
  service_.note_event(stillhand_msgs::EVENT_NOTE, text);
}

}  // namespace stillhand::vehicle
