// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/model/effect_kind.hpp"

#include <algorithm>

#include "services/contract/config_error.hpp"

namespace stillhand::diagnosis {

// What a kind doesn't do leaves the signal as it is.
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
bool EffectKind::through_body(const Effect& effect) const {
  return effect.form.find("through the body") != std::string::npos;
}
std::vector<double> EffectKind::own_poles(const Effect& /*effect*/,
                                          const Signals& /*signals*/) const {
  return {};
}
void EffectKind::weigh(const Effect& /*effect*/, const Signals& /*signals*/,
                       std::span<double> /*weight*/) const {}

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
