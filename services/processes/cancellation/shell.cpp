// SPDX-License-Identifier: Apache-2.0
#include "services/processes/cancellation/shell.hpp"

#include <array>
#include <cstdio>
#include <iostream>
#include <utility>

namespace stillhand::cancellation {
namespace {

// The condition is blinded, and events are not: the reason goes to the process's own log.
constexpr const char* kNotPrepared =
    "not prepared for what the trial assigns; the log of cancellation says why";
// More at once than the threads that prepare them took in meanwhile.
constexpr const char* kTooMany = "too many models or assignments at once";

}  // namespace

Shell::Shell(runtime::Service& service, const Config& config,
             std::optional<signal::Multisine> perturbation)
    : service_(service),
      config_(config),
      core_(config_),
      perturbs_(perturbation.has_value()),
      command_(service.bus().publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand)),
      parts_(config_, Recipe{.force = !perturbation, .perturbation = std::move(perturbation)},
             [this](const char* why) {
               service_.note_event(stillhand_msgs::EVENT_NOTE, kNotPrepared);
               log(why);
             }) {
  runtime::Bus& bus = service.bus();
  service.on_trial([this](const Trial& trial, const auto&) {
    arming_.announce(trial);
    note_when_armed();
  });
  bus.subscribe<stillhand_msgs::TrialAssignment>(
      topics::kTrialAssignment,
      [this](const auto& message, const auto&) { on_assignment(message); });
  bus.subscribe<stillhand_msgs::FeedthroughModel>(
      topics::kFeedthroughModel, [this](const auto& message, const auto&) {
        if (!message.usable()) return;
        if (message.to_position()) {
          if (!parts_.offer_position({message.control_rate_hz(), message.control_numerator(),
                                      message.control_denominator()})) {
            service_.note_event(stillhand_msgs::EVENT_NOTE, kTooMany);
          }
          return;
        }
        on_model({control_model(from_idl(message, config_.sampling)), message.model(),
                  message.from_tick()});
      });
  bus.subscribe<stillhand_msgs::AugmentedModel>(
      topics::kAugmentedModel, [this](const auto& message, const auto&) {
        on_model({from_idl(message), message.model(), message.from_tick()});
      });
  // The canceller watches every process's life sign through this topic; its content is not used.
  bus.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                               [](const auto&, const auto&) {});
  bus.subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

void Shell::note_when_armed() {
  const bool model_or_none_needed = core_.has_model() || (perturbs_ && arming_.cancels());
  const Readiness readiness =
      arming_.readiness(model_or_none_needed, schedule_.waits_for(), parts_.prepared());
  // Not armed: nor is it for a trial of the same number from before.
  service_.note_armed(readiness == Readiness::kArmed ? service_.trial().number : -1);
  if (const char* why = why_not(readiness)) {
    service_.note_event(stillhand_msgs::EVENT_NOTE, kNotPrepared);
    // A preparation that this replaces is made here, too.
    handover_.prepare([this, why] {
      log(why);
      return prepare_received();
    });
  }
}

const char* Shell::why_not(Readiness readiness) const noexcept {
  switch (readiness) {
    case Readiness::kUnassigned:
    case Readiness::kArmed:
    case Readiness::kNoMitigation:  // armed when it is prepared
      return nullptr;
    case Readiness::kNoModel:
      return why_no_model_.load();
    case Readiness::kModelTooLate:
      return "the model is for later than the trial";
    case Readiness::kMitigationTooLate:
      return "the mitigation cannot settle before the trial";
  }
  return nullptr;
}

// Of the threads that prepare: a terminal or a full disk may delay it.
void Shell::log(const char* why) { std::cerr << "stillhand-cancellation: " << why << '\n'; }

void Shell::on_assignment(const stillhand_msgs::TrialAssignment& message) {
  arming_.assign(from_idl(message));
  if (!parts_.want({parts_of(message), message.trial(), arming_.newest()})) {
    service_.note_event(stillhand_msgs::EVENT_NOTE, kTooMany);
  }
  note_when_armed();
}

void Shell::on_model(const Received& received) {
  why_no_model_.store("the model is being prepared");
  if (!received_.push(received)) {
    why_no_model_.store(kTooMany);
    service_.note_event(stillhand_msgs::EVENT_MODEL_REFUSED, kTooMany);
    return;
  }
  // The handover replaces a request that it has not begun; the queue keeps that request's model.
  handover_.prepare([this] { return prepare_received(); });
}

std::unique_ptr<Shell::Ready> Shell::prepare_received() {
  std::unique_ptr<Ready> newest;
  received_.consume_all([&](const Received& received) {
    Preparation preparation = prepare(received.model, bounds(config_));
    if (preparation.refusal == Refusal::kNone) {
      newest =
          std::make_unique<Ready>(Ready{preparation.model, received.number, received.from_tick});
      return;
    }
    const char* const why =
        describe(preparation.refusal).data();  // a literal: it outlives the note
    why_no_model_.store(why);
    service_.note_event(stillhand_msgs::EVENT_MODEL_REFUSED, why);
  });
  return newest;
}

void Shell::follow_models(Tick tick) {
  const Ready* const newest = handover_.current();
  const bool became_ready = newest != ready_;
  if (became_ready) {
    ready_ = newest;
    schedule_.offer(ready_->number, ready_->from_tick);
    service_.note_event(stillhand_msgs::EVENT_MODEL_LOADED, "");
  }
  const ModelSchedule::Due due = schedule_.step(tick);
  if (due.take) {
    core_.take(ready_->model);
    parts_.note_model(tick, arming_, core_);
    note_when_armed();
  }
  if (due.late_ticks > 0) {
    std::array<char, 100> text{};
    std::snprintf(text.data(), text.size(),
                  "model %d was ready %lld ticks after it could have been used", ready_->number,
                  static_cast<long long>(due.late_ticks));
    service_.note_event(stillhand_msgs::EVENT_NOTE, text.data());
  }
  if (became_ready) note_when_armed();
}

void Shell::note_interlock(const Trial& trial) {
  if (interlock_.latched(trial) == reported_latch_) return;
  reported_latch_ = !reported_latch_;
  if (!reported_latch_) return;
  service_.note_event(stillhand_msgs::EVENT_INTERLOCK_OPENED, service_.bus().why_not_alive());
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  follow_models(sensed.tick());
  const Trial& trial = service_.trial();
  const bool permitted = interlock_.step(trial, sensed.tick(), service_.bus().peers_alive());
  note_interlock(trial);
  if (parts_.follow(sensed.tick(), arming_, core_)) note_when_armed();
  CountermeasureInput input =
      from_idl(sensed, parts_.enables(sensed.tick(), arming_, core_), permitted);
  input.trial = trial;
  auto message =
      to_idl(core_.step(input), input, sensed, schedule_.in_use(), parts_.trial_of(core_));
  command_.write(message);
  service_.note_tick(sensed.tick());
}

}  // namespace stillhand::cancellation
