// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

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

/// The one list.  Of those that explain as much, as far as the blocks can say, with as many
/// numbers, the earliest is named, METHOD Eq. DG-17.
inline constexpr std::array kEffectKinds{&delay_kind,
                                         &resonance_kind,
                                         &coupled_input_kind,
                                         &coulomb_friction_kind,
                                         &hysteresis_kind,
                                         &nonlinear_stiffness_kind,
                                         &asymmetry_kind,
                                         &dead_zone_kind,
                                         &output_saturation_kind,
                                         &input_saturation_kind,
                                         &position_ripple_kind,
                                         &tone_kind,
                                         &drift_kind,
                                         &time_varying_gain_kind,
                                         &regime_change_kind,
                                         &clock_drift_kind,
                                         &bilinear_kind,
                                         &transients_kind,
                                         &free_form_kind};

}  // namespace stillhand::diagnosis
