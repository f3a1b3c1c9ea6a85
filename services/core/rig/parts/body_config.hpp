// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"
#include "services/core/rig/parts/neuromuscular_config.hpp"

namespace stillhand::rig {

/// Seated subject as a lateral chain seat - trunk - arm - grip - hand, METHOD Eq. RG-3.  The values
/// describe the idle, relaxed hand; the factors `cocontraction_*` give those of a tracking hand.
/// They are the mean subject's of services/core/population, rounded.
/// The ranges cover a population of subjects; METHOD, "Where the numbers come from".
struct BodyConfig {
  double trunk_mass_kg = 30.0;                  ///< m_t
  double seat_stiffness_n_m = 12280.0;          ///< k_t
  double seat_damping_n_s_m = 400.6;            ///< c_t
  double arm_mass_kg = 1.1025;                  ///< m_a
  double shoulder_stiffness_n_m = 1160.0;       ///< k_a
  double shoulder_damping_n_s_m = 11.87;        ///< c_a
  double grip_stiffness_n_m = 2400.0;           ///< k_h
  double grip_damping_n_s_m = 11.6;             ///< c_h
  double arm_rest_stiffness_n_m = 0.0;          ///< k_r, arm to platform; 0: no arm rest
  double arm_rest_damping_n_s_m = 0.0;          ///< c_r
  double hand_mass_kg = 0.30;                   ///< m_h, moves with the handle
  double cocontraction_stiffness_factor = 1.6;  ///< on k_a and k_h while not pegged
  double cocontraction_damping_factor = 1.265;  ///< on c_a and c_h while not pegged
  /// `{}` is a hand without nerves: a linear chain.
  NeuromuscularConfig neuromuscular{.wander = 0.1,
                                    .involuntary_force_n = 0.4,
                                    .tremor_force_n = 0.03,
                                    .unmeasured_force_n_s2_m = 0.75};

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("trunk_mass_kg", self.trunk_mass_kg, Range{12.0, 70.0},
          "[kg] m_t, upper body that moves on the seat; 0.4 of body mass, Winter (2009) table 4.1");
    visit("seat_stiffness_n_m", self.seat_stiffness_n_m, Range{1000.0, 60000.0},
          "[N/m] k_t, seat and harness, lateral; first mode 1.5 to 4 Hz with back support, Fairley "
          "and Griffin (1990)");
    visit("seat_damping_n_s_m", self.seat_damping_n_s_m, Range{20.0, 3000.0},
          "[N s/m] c_t; damping ratio 0.2 to 0.45 of the first mode, Fairley and Griffin (1990)");
    visit(
        "arm_mass_kg", self.arm_mass_kg, Range{0.3, 4.0},
        "[kg] m_a, inertia of the arm felt at the hand; Mussa-Ivaldi et al. (1985), Winter (2009)");
    visit("shoulder_stiffness_n_m", self.shoulder_stiffness_n_m, Range{50.0, 5000.0},
          "[N/m] k_a, shoulder and elbow felt at the hand; Mussa-Ivaldi et al. (1985), Perreault "
          "et al. (2002)");
    visit("shoulder_damping_n_s_m", self.shoulder_damping_n_s_m, Range{0.5, 300.0},
          "[N s/m] c_a; damping ratio 0.1 to 0.4 of the arm, Perreault et al. (2004)");
    visit("grip_stiffness_n_m", self.grip_stiffness_n_m, Range{200.0, 20000.0},
          "[N/m] k_h, palm and wrist around the handle; Hasser and Cutkosky (2002)");
    visit("grip_damping_n_s_m", self.grip_damping_n_s_m, Range{0.5, 300.0},
          "[N s/m] c_h, palm and wrist; Hasser and Cutkosky (2002)");
    visit("arm_rest_stiffness_n_m", self.arm_rest_stiffness_n_m, Range{0.0, 5000.0},
          "[N/m] k_r, padded rest under the forearm, fixed to the platform; the subjects of the "
          "paper were instructed not to use theirs");
    visit("arm_rest_damping_n_s_m", self.arm_rest_damping_n_s_m, Range{0.0, 300.0},
          "[N s/m] c_r, damping of the same arm rest");
    visit("hand_mass_kg", self.hand_mass_kg, Range{0.05, 0.8},
          "[kg] m_h, part of the hand that moves with the handle; hand 0.006 of body mass, Winter "
          "(2009) table 4.1");
    visit("cocontraction_stiffness_factor", self.cocontraction_stiffness_factor, Range{1.0, 4.0},
          "[-] ratio of the stiffness of shoulder and grip while tracking to that of the idle "
          "hand; 1.2 to 2, Gomi and Osu (1998)");
    visit("cocontraction_damping_factor", self.cocontraction_damping_factor, Range{1.0, 4.0},
          "[-] the same ratio for damping; the square root of the stiffness factor keeps the "
          "damping ratio");
    visit.group("neuromuscular", self.neuromuscular);
  }
};

/// Joystick; all quantities refer to the hand [N, kg, m], METHOD Eq. RG-4 and RG-5.
struct StickConfig {
  double lever_m = 0.10;                   ///< r, hand to pivot
  double handle_mass_kg = 0.10;            ///< m_g, above the load cell; a_y acts on it
  double drive_mass_kg = 0.25;             ///< m_d, rotor, drum and stem; balanced about the pivot
  double viscous_damping_n_s_m = 0.5;      ///< b
  double coulomb_friction_n = 0.2;         ///< F_c
  double centring_stiffness_n_m = 0.0;     ///< k_c
  double stop_angle_rad = 0.523598775598;  ///< 30 degrees, each side
  double stop_stiffness_n_m = 50000.0;     ///< k_s
  double stop_damping_n_s_m = 150.0;       ///< c_s
  double stop_travel_m = 0.002;            ///< rubber ends, steel begins
  double peg_seat_time_s = 0.1;            ///< time constant of the peg as it moves the stick to 0

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("lever_m", self.lever_m, Range{0.02, 0.5}, "[m] hand to pivot; paper II (10 cm)");
    visit("handle_mass_kg", self.handle_mass_kg, Range{0.01, 1.0},
          "[kg] m_g, handle above the load cell, unbalanced; aluminium grip of 0.1 m");
    visit("drive_mass_kg", self.drive_mass_kg, Range{0.02, 2.0},
          "[kg] m_d, balanced inertia below the load cell divided by lever squared; rotor 1.4e-5 "
          "kg m^2 (maxon RE 40 data sheet) through a 10:1 capstan is 0.14 kg; drum and stem add "
          "about the same");
    visit("viscous_damping_n_s_m", self.viscous_damping_n_s_m, Range{0.0, 50.0},
          "[N s/m] b, bearings and back-emf of a current-driven motor");
    visit("coulomb_friction_n", self.coulomb_friction_n, Range{0.0, 5.0},
          "[N] F_c, brushes and capstan; 0.1 to 0.3 N is usual for capstan devices");
    visit("centring_stiffness_n_m", self.centring_stiffness_n_m, Range{0.0, 2000.0},
          "[N/m] k_c, centring spring; the stick of the paper has none");
    visit("stop_angle_rad", self.stop_angle_rad, Range{0.05, 1.2},
          "[rad] angle of the mechanical stop, each side; paper III-C (30 degrees)");
    visit("stop_stiffness_n_m", self.stop_stiffness_n_m, Range{2000.0, 500000.0},
          "[N/m] k_s, rubber of the stop");
    visit("stop_damping_n_s_m", self.stop_damping_n_s_m, Range{0.0, 5000.0},
          "[N s/m] c_s, rubber of the stop");
    visit("stop_travel_m", self.stop_travel_m, Range{0.0001, 0.02},
          "[m] depth of the rubber; the stick never goes deeper");
    visit("peg_seat_time_s", self.peg_seat_time_s, Range{0.01, 2.0},
          "[s] time constant of the tapered peg as it moves the stick to its centre");
  }
};

}  // namespace stillhand::rig
