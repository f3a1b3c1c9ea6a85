// SPDX-License-Identifier: Apache-2.0
#include "services/processes/cancellation/trial_parts.hpp"

#include <algorithm>
#include <utility>

#include "services/core/cancellation/parts/recipe.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation {

TrialParts::TrialParts(const Config& config, const Recipe& cancelling,
                       std::function<void(const char*)> refused)
    : config_(config), refused_(std::move(refused)), cancelling_(cancelling) {}

bool TrialParts::want(const Wanted& wanted) { return ask(wanted_in_.push(wanted)); }
bool TrialParts::offer_position(const signal::DifferenceModel& model) {
  return ask(positions_in_.push(model));
}

// Each request makes whatever is wanted by then, so one that replaces another loses nothing.
bool TrialParts::ask(bool pushed) {
  if (pushed) handover_.prepare([this] { return make(); });
  return pushed;
}

bool TrialParts::listen() {
  bool position = false;
  bool other = false;
  positions_in_.consume_all([&](signal::DifferenceModel& model) {
    position_ = std::move(model);
    position = true;
  });
  wanted_in_.consume_all([&](Wanted& wanted) {
    wanted_ = std::move(wanted);
    other = true;
  });
  return !wanted_.parts.empty() && (other || (position && needs_position(wanted_.parts)));
}

std::unique_ptr<TrialParts::Running> TrialParts::make() {
  if (!listen()) return nullptr;
  try {
    return std::make_unique<Running>(Running{PartList(recipe_of(wanted_.parts, position_, config_)),
                                             wanted_.trial,
                                             {wanted_.assignment}});
  } catch (const ConfigError& error) {
    refused_(error.what());
    return nullptr;  // the trial is never armed, and so never begins
  }
}

PartList& TrialParts::wanted(const TrialArming& arming) noexcept {
  if (arming.cancels()) return cancelling_;
  return running_ != nullptr && running_->prepared.assignment == arming.newest() ? running_->parts
                                                                                 : nothing_;
}

// Within a trial, the model before acts until the new one has settled.
void TrialParts::note_model(Tick tick, const TrialArming& arming,
                            const Countermeasure& core) noexcept {
  if (running_ == nullptr || !running_->parts.needs_force() || arming.begun(tick)) return;
  Tick& in_effect = running_->prepared.in_effect;
  in_effect = std::max(in_effect, tick + core.unsettled_ticks());
}

bool TrialParts::follow(Tick tick, const TrialArming& arming, Countermeasure& core) noexcept {
  if (core.acts()) return false;
  bool took = false;
  // Those of a trial that has begun stay, whatever model has come since.
  if (prepared().assignment != arming.newest() || !arming.begun(tick)) {
    Running* const newest = handover_.current();
    took = newest != running_;
    if (took) {
      running_ = newest;
      running_->prepared.in_effect = tick + running_->parts.settle_ticks() + config_.fade_ticks;
      note_model(tick, arming, core);
    }
  }
  PartList& parts = wanted(arming);
  if (!core.runs(parts)) core.use(parts);
  return took;
}

}  // namespace stillhand::cancellation
