// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/shell.hpp"

#include <string>

namespace stillhand::cancellation {

Shell::Shell(runtime::Service& service)
    : service_(service),
      core_(service.config<Config>()),
      command_(service.bus().publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand)) {
  runtime::Bus& bus = service.bus();
  service.on_trial([this](const Trial&, const auto&) { note_when_armed(); });
  bus.subscribe<stillhand_msgs::TrialAssignment>(topics::kTrialAssignment,
                                                 [this](const auto& message, const auto&) {
                                                   assignment_ = message;
                                                   note_when_armed();
                                                 });
  bus.subscribe<stillhand_msgs::FeedthroughModel>(
      topics::kFeedthroughModel, [this](const auto& message, const auto&) {
        if (!message.usable()) return;
        on_model(control_model(from_idl(message)), message.model(), message.from_tick());
      });
  bus.subscribe<stillhand_msgs::AugmentedModel>(
      topics::kAugmentedModel, [this](const auto& message, const auto&) {
        on_model(from_idl(message), message.model(), message.from_tick());
      });
  // The canceller watches everybody's life sign through this topic; its content is not used.
  bus.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                               [](const auto&, const auto&) {});
  bus.subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

void Shell::note_when_armed() {
  if (!assignment_ || assignment_->trial() != service_.trial().number) return;
  // A trial that is to be cancelled and is not would pass for one that was.
  const bool in_time = ready_ && ready_->from_tick <= service_.trial().start_tick;
  if (assignment_->cancellation() && !core_.has_model() && !in_time) {
    service_.note_event(stillhand_msgs::EVENT_NOTE,
                        ready_ ? "the model is for later than the trial" : why_no_model_);
    return;
  }
  service_.note_armed(service_.trial().number);
}

void Shell::on_model(const ControlModel& model, std::int32_t number, Tick from_tick) {
  const Refusal refusal = core_.make_ready(model);
  if (refusal == Refusal::kNone) {
    ready_ = ReadyModel{number, from_tick};
    service_.note_event(stillhand_msgs::EVENT_MODEL_LOADED, "");
    note_when_armed();
  } else {
    // The texts are literals: they outlive the note.
    why_no_model_ = describe(refusal).data();
    service_.note_event(stillhand_msgs::EVENT_MODEL_REFUSED, why_no_model_);
  }
}

// At a tick that was told beforehand, so that a replay takes it at the same one.
void Shell::take_model_when_due(Tick tick) {
  if (!ready_ || tick < ready_->from_tick) return;
  core_.take_ready_model();
  model_ = ready_->number;
  ready_.reset();
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  take_model_when_due(sensed.tick());
  const Trial& trial = service_.trial();
  const bool permitted = interlock_.step(trial, sensed.tick(), service_.bus().peers_alive());
  if (interlock_.latched(trial) != told_latch_) {
    told_latch_ = !told_latch_;
    if (told_latch_) {
      service_.note_event(stillhand_msgs::EVENT_INTERLOCK_OPENED, service_.bus().replay_present()
                                                                      ? "a replay is on the bus"
                                                                      : "a process is missing");
    }
  }
  const bool enabled = assignment_ && assignment_->trial() == trial.number &&
                       assignment_->cancellation() && trial.phase == TrialPhase::kTracking &&
                       trial.covers(sensed.tick());
  const CancellerInput input = from_idl(sensed, enabled, permitted);
  auto message = to_idl(core_.step(input), input, sensed, model_);
  command_.write(message);
  service_.note_tick(sensed.tick());
}

}  // namespace stillhand::cancellation
