// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {

// The kinds of effect; the equation of each, and its source, stand at its class.
const EffectKind& asymmetry_kind();
const EffectKind& bilinear_kind();
const EffectKind& clock_drift_kind();
const EffectKind& coulomb_friction_kind();
const EffectKind& coupled_input_kind();
const EffectKind& dead_zone_kind();
const EffectKind& delay_kind();
const EffectKind& drift_kind();
const EffectKind& free_form_kind();
const EffectKind& hysteresis_kind();
const EffectKind& input_saturation_kind();
const EffectKind& nonlinear_stiffness_kind();
const EffectKind& output_saturation_kind();
const EffectKind& position_ripple_kind();
const EffectKind& regime_change_kind();
const EffectKind& resonance_kind();
const EffectKind& time_varying_gain_kind();
const EffectKind& tone_kind();
const EffectKind& transients_kind();

}  // namespace stillhand::diagnosis
