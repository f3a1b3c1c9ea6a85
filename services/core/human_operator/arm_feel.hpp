// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::human_operator {

/// Dynamics of stick and arm at the hand, as the subject has learnt them, and the bounds of the
/// subject's force:
///
///   f = M a + B v + K x,   x hand displacement from upright [m], + right
///
/// J^* of the paper is 1 / (M s^2 + B s + K): joystick with the arm's driving-point impedance.
/// Source: README Eq. HO-1; paper Eq. 2.
struct ArmFeel {
  double effective_mass_kg = 1.394;
  double effective_damping_n_s_m = 11.18;
  double effective_stiffness_n_m = 1136.0;
  double cursor_per_hand = 6.0;
  double max_force_n = 40.0;
  double max_slew_n_s = 2000.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("effective_mass_kg", self.effective_mass_kg, Range{0.05, 5.0},
          "[kg] M felt at the hand below 1 Hz; README, \"What the stick feels like\"");
    visit("effective_damping_n_s_m", self.effective_damping_n_s_m, Range{0.0, 300.0},
          "[N s/m] B felt at the hand below 1 Hz; README, \"What the stick feels like\"");
    visit("effective_stiffness_n_m", self.effective_stiffness_n_m, Range{0.0, 5000.0},
          "[N/m] K: shoulder, grip and seat of the rig's body in series, co-contracted");
    visit("cursor_per_hand", self.cursor_per_hand, Range{0.1, 100.0},
          "[m/m] cursor displacement per hand displacement; paper III-C (0.6 m/rad) and II (0.10 m "
          "lever)");
    visit("max_force_n", self.max_force_n, Range{0.0, 60.0},
          "[N] largest volitional force, twice the force for the whole screen; README, \"Bounds\"");
    visit("max_slew_n_s", self.max_slew_n_s, Range{1.0, 20000.0},
          "[N/s] largest rate of change of the volitional force; README, \"Bounds\"");
  }

  /// Eq. HO-1.
  [[nodiscard]] double force(double x_m, double v_m_s, double a_m_s2) const noexcept {
    return effective_mass_kg * a_m_s2 + effective_damping_n_s_m * v_m_s +
           effective_stiffness_n_m * x_m;
  }
};

/// Ticks in which the force fades to zero when the subject has no valid input.
inline constexpr std::int64_t kFade_ticks = 50;

/// The envelope that bounds the volitional force; it is the last stage.
inline signal::ForceEnvelope force_envelope(const ArmFeel& feel) {
  return signal::ForceEnvelope({feel.max_force_n, feel.max_slew_n_s, kFade_ticks});
}

}  // namespace stillhand::human_operator
