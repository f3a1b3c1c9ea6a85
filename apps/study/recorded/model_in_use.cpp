// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/model_in_use.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "services/messages/cancellation/codec.hpp"

namespace stillhand::study {
namespace {

using measurement::SessionTrial;
using session::SessionRecording;

// The newest of the models that may be used at a tick; they come in the order of their writing.
template <typename Model>
const Model* newest(const std::vector<Model>& models, Tick tick, std::uint32_t rig) {
  const Model* out = nullptr;
  for (const Model& model : models) {
    if (model.rig() == rig && model.from_tick() <= tick) out = &model;
  }
  return out;
}

// At most one of both; none: the recording holds no model of that time.
struct InForce {
  const stillhand_msgs::AugmentedModel* control = nullptr;
  const stillhand_msgs::FeedthroughModel* identified = nullptr;

  [[nodiscard]] std::optional<std::int32_t> number() const {
    if (control != nullptr) return control->model();
    return identified == nullptr ? std::nullopt : std::optional(identified->model());
  }
};

InForce in_force(const SessionRecording& recorded, Tick tick, std::uint32_t rig) {
  InForce out{newest(recorded.control_models, tick, rig), newest(recorded.models, tick, rig)};
  if (out.control == nullptr || out.identified == nullptr) return out;
  const bool identified_later = out.identified->from_tick() > out.control->from_tick();
  return identified_later ? InForce{nullptr, out.identified} : InForce{out.control, nullptr};
}

// The reason, if the canceller's last answer to a model before that tick is a refusal.
std::optional<std::string> refusal_before(const SessionRecording& recorded, Tick tick,
                                          std::uint32_t rig) {
  std::optional<std::string> out;
  for (const stillhand_msgs::Event& event : recorded.events) {
    if (event.rig() != rig || event.tick() >= tick) continue;
    if (event.kind() == stillhand_msgs::EVENT_MODEL_REFUSED) out = event.text().c_str();
    if (event.kind() == stillhand_msgs::EVENT_MODEL_LOADED) out.reset();
  }
  return out;
}

// Of a trial's recorded commands.
constexpr double kMostOther = 0.01;

std::string not_mitigated_in(const SessionRecording& recorded, const SessionTrial& trial,
                             std::uint32_t rig) {
  std::int64_t commands = 0;
  std::int64_t others = 0;
  for (const stillhand_msgs::MotorCommand& command : recorded.motor_commands) {
    if (command.rig() != rig || !trial.holds(command.tick())) continue;
    ++commands;
    if (!command.enabled() || command.mitigated_trial() != trial.trial.number) ++others;
  }
  if (commands == 0) return "has no motor command, which would name its mitigation";
  const double share = static_cast<double>(others) / static_cast<double>(commands);
  if (share <= kMostOther) return "";
  return fmt::format("ran without {} in {:.0f} % of it", trial.named, 100.0 * share);
}

// The model of an input alone; its map may be anything.
bool is_one_input(const cancellation::ControlModel& model) {
  return model.inputs.size() == 1 && !model.loop && model.output.values.empty() &&
         model.paths.empty() && model.waves.empty();
}

bool is_identified(const SessionRecording& recorded, const cancellation::ControlModel& model) {
  return is_one_input(model) && std::ranges::any_of(recorded.models, [&](const auto& each) {
           return each.control_numerator() == model.inputs[0].numerator &&
                  each.control_denominator() == model.denominator;
         });
}

std::string name_of(std::int32_t model) {
  return model < 0 ? "no model" : fmt::format("model {}", model);
}

}  // namespace

std::optional<Condition> condition_in(const SessionRecording& recorded, const SessionTrial& trial,
                                      std::uint32_t rig) {
  if (!trial.named.empty()) {
    const auto named = session::condition_named(trial.named);
    return named && is_mitigation(*named) ? named : std::nullopt;
  }
  if (trial.letter != 'C') return session::condition_named(std::string_view(&trial.letter, 1));
  const auto* control = in_force(recorded, trial.trial.start_tick, rig).control;
  if (control == nullptr) return kC;
  const cancellation::ControlModel model = cancellation::from_idl(*control);
  if (!is_identified(recorded, model) || !model.inputs[0].map.values.empty()) return kCPlus;
  return model.adapts ? kCPrime : kC;
}

bool adds_nothing(const SessionRecording& recorded, const SessionTrial& trial, std::uint32_t rig) {
  const auto* control = in_force(recorded, trial.trial.start_tick, rig).control;
  if (control == nullptr) return false;
  const cancellation::ControlModel model = cancellation::from_idl(*control);
  if (!is_identified(recorded, model)) return false;
  const cancellation::ValueMap& map = model.inputs[0].map;
  return map.values == std::vector<double>{map.low, map.high};
}

std::string other_model_in(const SessionRecording& recorded, const SessionTrial& trial,
                           std::uint32_t rig) {
  if (!trial.named.empty()) return not_mitigated_in(recorded, trial, rig);
  if (trial.letter != 'C') return "";
  const Tick start = trial.trial.start_tick;
  const std::optional<std::int32_t> given = in_force(recorded, start, rig).number();
  const std::optional<std::string> refused = refusal_before(recorded, start, rig);
  std::map<std::int32_t, std::int64_t> ran;
  std::int64_t commands = 0;
  for (const stillhand_msgs::MotorCommand& command : recorded.motor_commands) {
    if (command.rig() != rig || !trial.holds(command.tick())) continue;
    ++ran[command.model()];
    ++commands;
  }
  if (commands == 0) {
    return refused ? "had a model that the canceller refused: " + *refused : "";
  }
  if (!given) {
    return static_cast<double>(ran[-1]) > kMostOther * static_cast<double>(commands)
               ? "ran no model"
               : "";
  }
  const auto other = std::ranges::max_element(ran, {}, [&](const auto& each) {
    return each.first == *given ? std::int64_t{0} : each.second;
  });
  const double share = static_cast<double>(commands - ran[*given]) / static_cast<double>(commands);
  if (share <= kMostOther) return "";
  return fmt::format("ran {} in place of {} in {:.0f} % of it{}", name_of(other->first),
                     name_of(*given), 100.0 * share,
                     refused ? "; the canceller refused it: " + *refused : "");
}

}  // namespace stillhand::study
