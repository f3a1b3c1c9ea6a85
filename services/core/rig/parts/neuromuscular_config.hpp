// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"

namespace stillhand::rig {

/// What nerves and muscles add to the linear body of Eq. RG-3; 0 everywhere by default.  A hand on
/// the pegged stick is idle: it has no reflex, and neither vibration nor motor stiffens it.
/// Source: METHOD Eq. RG-27 to RG-32 and "What a person adds".
struct NeuromuscularConfig {
  double stiffening_by_vibration_s2_m = 0.0;
  double stiffening_by_motor_n = 0.0;
  double wander = 0.0;
  double wander_time_s = 60.0;
  double change = 0.0;
  double change_at_s = 0.0;
  double reflex_stiffness_n_m = 0.0;
  double reflex_damping_n_s_m = 0.0;
  double reflex_delay_s = 0.04;
  double reflex_muscle_hz = 2.2;
  double reflex_muscle_damping = 0.75;
  double reflex_max_force_n = 30.0;
  double motor_resistance = 0.0;
  double motor_resistance_delay_s = 0.1;
  double involuntary_force_n = 0.0;
  double tremor_force_n = 0.0;
  double unmeasured_force_n_s2_m = 0.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("stiffening_by_vibration_s2_m", self.stiffening_by_vibration_s2_m, Range{-0.3, 2.0},
          "[s^2/m] growth of the stiffness of shoulder and grip per m/s^2 RMS of platform motion; "
          "below 0 it softens, Eq. RG-27");
    visit("stiffening_by_motor_n", self.stiffening_by_motor_n, Range{0.0, 1.0},
          "[1/N] growth of the same stiffness per N RMS of motor force, Eq. RG-27");
    visit("wander", self.wander, Range{0.0, 0.5},
          "[-] standard deviation of the logarithm of the same stiffness over time, Eq. RG-28");
    visit("wander_time_s", self.wander_time_s, Range{1.0, 3600.0},
          "[s] time constant of that wander");
    visit(
        "change", self.change, Range{-0.5, 3.0},
        "[-] growth of the same stiffness, once and for good: another posture or grip, Eq. RG-40");
    visit("change_at_s", self.change_at_s, Range{0.0, 100000.0},
          "[s] when it changes, from the session's first tick");
    visit("reflex_stiffness_n_m", self.reflex_stiffness_n_m, Range{0.0, 1000.0},
          "[N/m] stretch reflex of the shoulder: force a metre of stretch, Eq. RG-29");
    visit("reflex_damping_n_s_m", self.reflex_damping_n_s_m, Range{0.0, 100.0},
          "[N s/m] the same: force per speed of stretch");
    visit("reflex_delay_s", self.reflex_delay_s, Range{0.01, 0.15},
          "[s] from stretch to the nerve's command to the muscle");
    visit("reflex_muscle_hz", self.reflex_muscle_hz, Range{0.5, 10.0},
          "[Hz] natural frequency of the muscle's activation");
    visit("reflex_muscle_damping", self.reflex_muscle_damping, Range{0.1, 0.95},
          "[-] its damping ratio");
    visit("reflex_max_force_n", self.reflex_max_force_n, Range{0.0, 60.0},
          "[N] largest force of the reflex");
    visit("motor_resistance", self.motor_resistance, Range{0.0, 1.0},
          "[-] share of the motor's force that the hand opposes, Eq. RG-30");
    visit("motor_resistance_delay_s", self.motor_resistance_delay_s, Range{0.01, 0.5},
          "[s] from motor force to opposing force");
    visit("involuntary_force_n", self.involuntary_force_n, Range{0.0, 5.0},
          "[N] RMS of the slow involuntary force on the handle, 0.1 to 5 Hz, Eq. RG-31");
    visit("tremor_force_n", self.tremor_force_n, Range{0.0, 2.0},
          "[N] RMS of the tremor force, 7 to 12 Hz, Eq. RG-31");
    visit(
        "unmeasured_force_n_s2_m", self.unmeasured_force_n_s2_m, Range{0.0, 5.0},
        "[N s^2/m] RMS force from motion that a_y does not show, per m/s^2 RMS of a_y, Eq. RG-32");
  }
};

}  // namespace stillhand::rig
