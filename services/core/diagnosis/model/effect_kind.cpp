// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/effect_kind.hpp"

#include <algorithm>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::diagnosis {

ControlRole EffectKind::body_role(const Effect& effect) const {
  switch (stage(effect)) {
    case Stage::kInputTime:
      return control::InputDelay{};
    case Stage::kInputValue:
      return control::InputMap{};
    case Stage::kFeedback:
      return control::Spring{};
    case Stage::kGain:
      if (time_only(effect)) return control::Gain{};
      return control::LeftOut{"the canceller has no gain that follows a channel"};
    case Stage::kOutputValue:
      return control::OutputMap{};
    case Stage::kTerm:
    case Stage::kWeight:
      break;
  }
  return control::LeftOut{"the canceller has no law of this form"};
}
ControlRole EffectKind::drive_role(const Effect& /*effect*/) const {
  return control::LeftOut{"the canceller has no law of this form for the drive"};
}

std::vector<Size> EffectKind::sizes(const SizeCase& /*at*/) const { return {}; }
std::optional<std::complex<double>> EffectKind::path(const SizeCase& /*at*/,
                                                     double /*frequency_hz*/) const {
  return {};
}

// A function that a kind does not override leaves the signal as it is.
double EffectKind::input_delay_s(const Effect& /*effect*/, double /*time_s*/) const { return 0.0; }
double EffectKind::mapped(const Effect& /*effect*/, double value) const { return value; }
double EffectKind::slope(const Effect& /*effect*/, double /*value*/) const { return 1.0; }
Nonlinearity EffectKind::feedback(const Effect& /*effect*/) const {
  return {[](double /*z*/, LoopMemory& /*memory*/) { return 0.0; }, 1.0};
}
void EffectKind::gain(const Effect& /*effect*/, const Signals& /*signals*/,
                      std::span<double> /*gain*/) const {}
void EffectKind::terms(const Effect& /*effect*/, const Signals& /*signals*/,
                       const std::vector<double>& /*body_output*/, Columns& /*columns*/) const {}
std::string EffectKind::column_unit(const Effect& /*effect*/, const Signals& /*signals*/,
                                    std::size_t /*i*/) const {
  return "-";
}
bool EffectKind::through_body(const Effect& effect) const {
  return effect.form.find("through the body") != std::string::npos;
}
std::vector<double> EffectKind::own_poles(const Effect& /*effect*/, double /*rate_hz*/) const {
  return {};
}
void EffectKind::weigh(const Effect& /*effect*/, const Signals& /*signals*/,
                       std::span<double> /*weight*/) const {}

double delay_in_part(const Effect& effect, double time_s) {
  return effect.share * effect_kind(effect.kind).input_delay_s(effect, time_s);
}

double mapped_in_part(const EffectKind& kind, const Effect& effect, double value) {
  const double whole = kind.mapped(effect, value);
  return effect.is_whole() ? whole : value + effect.share * (whole - value);
}

double slope_in_part(const EffectKind& kind, const Effect& effect, double value) {
  const double whole = kind.slope(effect, value);
  return effect.is_whole() ? whole : 1.0 + effect.share * (whole - 1.0);
}

void gain_in_part(const Effect& effect, const Signals& signals, std::span<double> gain) {
  const EffectKind& kind = effect_kind(effect.kind);
  if (effect.is_whole()) return kind.gain(effect, signals, gain);
  std::vector<double> whole(gain.size(), 1.0);
  kind.gain(effect, signals, whole);
  for (std::size_t n = 0; n < gain.size(); ++n) gain[n] *= 1.0 + effect.share * (whole[n] - 1.0);
}

bool acts_at(const Effect& effect, Stage stage) {
  return effect_kind(effect.kind).stage(effect) == stage;
}

const Effect* feedback_of(const Model& model) {
  const Effect* feedback = nullptr;
  for (const Effect& effect : model.effects) {
    if (!acts_at(effect, Stage::kFeedback)) continue;
    STILLHAND_EXPECTS(feedback == nullptr);
    feedback = &effect;
  }
  return feedback;
}

bool passes_through_body(const Model& model) {
  return std::ranges::any_of(model.effects, [](const Effect& effect) {
    return effect_kind(effect.kind).through_body(effect);
  });
}

const EffectKind& effect_kind(std::string_view name) {
  const auto& kinds = effect_kinds();
  const auto found =
      std::ranges::find_if(kinds, [&](const EffectKind* kind) { return kind->name() == name; });
  if (found == kinds.end()) {
    throw ConfigError("effect.kind", "'" + std::string(name) + "'",
                      "a kind that this version knows, for example 'delay'");
  }
  return **found;
}

}  // namespace stillhand::diagnosis
