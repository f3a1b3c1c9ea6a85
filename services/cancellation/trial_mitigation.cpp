// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/trial_mitigation.hpp"

#include <utility>

#include "services/contract/config_error.hpp"

namespace stillhand::cancellation {

TrialMitigation::TrialMitigation(const Config& config, std::function<void(const char*)> refused)
    : config_(config), refused_(std::move(refused)) {}

bool TrialMitigation::want(const Wanted& wanted) { return ask(wanted_in_.push(wanted)); }
bool TrialMitigation::offer_force(const ControlModel& model) { return ask(forces_in_.push(model)); }
bool TrialMitigation::offer_position(const signal::DifferenceModel& model) {
  return ask(positions_in_.push(model));
}

// Each request makes whatever is wanted by then, so one that replaces another loses nothing.
bool TrialMitigation::ask(bool pushed) {
  if (pushed) handover_.prepare([this] { return make(); });
  return pushed;
}

bool TrialMitigation::listen() {
  bool force = false;
  bool position = false;
  bool other = false;
  forces_in_.consume_all([&](ControlModel& model) {
    models_.force = std::move(model);
    force = true;
  });
  positions_in_.consume_all([&](signal::DifferenceModel& model) {
    models_.position = std::move(model);
    position = true;
  });
  wanted_in_.consume_all([&](Wanted& wanted) {
    wanted_ = std::move(wanted);
    other = true;
  });
  if (wanted_.parts.empty()) return false;
  return other || (force && needs_force(wanted_.parts)) ||
         (position && needs_position(wanted_.parts));
}

std::unique_ptr<TrialMitigation::Running> TrialMitigation::make() {
  if (!listen()) return nullptr;
  try {
    return std::make_unique<Running>(
        Running{mitigation::Mitigation(recipe_of(wanted_.parts, models_, config_)),
                wanted_.trial,
                {wanted_.assignment}});
  } catch (const ConfigError& error) {
    refused_(error.what());
    return nullptr;  // the trial is never armed, and so never begins
  }
}

bool TrialMitigation::follow(Tick tick, const TrialArming& arming) noexcept {
  if (running_ != nullptr) {
    const bool wanted = running_->prepared.assignment == arming.newest();
    if (running_->acts || (wanted && arming.begun(tick))) return false;
  }
  Running* const newest = handover_.current();
  if (newest == running_) return false;
  running_ = newest;
  running_->prepared.in_effect = tick + running_->core.settle_ticks() + config_.fade_ticks;
  return true;
}

std::optional<TrialMitigation::Answer> TrialMitigation::step(const CancellerInput& input,
                                                             const TrialArming& arming) noexcept {
  if (running_ == nullptr) return {};
  if (running_->prepared.assignment != arming.newest() && !running_->acts) return {};
  CancellerInput asked = input;
  asked.enabled = arming.mitigates(input.tick, running_->prepared);
  const mitigation::MitigationOutput done = running_->core.step(asked);
  running_->acts = done.force_n != 0.0 || done.taken_off_rad != 0.0;
  return Answer{done, asked, running_->trial};
}

}  // namespace stillhand::cancellation
