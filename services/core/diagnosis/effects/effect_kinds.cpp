// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effects/kinds.hpp"

namespace stillhand::diagnosis {

// The one list: a new kind adds its line here.  Of those that explain as much, as far as the blocks
// can say, with as many numbers, the earliest is named, METHOD Eq. DG-17.
const std::vector<const EffectKind*>& effect_kinds() {
  static const std::vector<const EffectKind*> kKinds{&delay_kind(),
                                                     &resonance_kind(),
                                                     &coupled_input_kind(),
                                                     &coulomb_friction_kind(),
                                                     &hysteresis_kind(),
                                                     &nonlinear_stiffness_kind(),
                                                     &asymmetry_kind(),
                                                     &dead_zone_kind(),
                                                     &output_saturation_kind(),
                                                     &input_saturation_kind(),
                                                     &position_ripple_kind(),
                                                     &tone_kind(),
                                                     &drift_kind(),
                                                     &time_varying_gain_kind(),
                                                     &regime_change_kind(),
                                                     &clock_drift_kind(),
                                                     &bilinear_kind(),
                                                     &transients_kind(),
                                                     &free_form_kind()};
  return kKinds;
}

}  // namespace stillhand::diagnosis
