// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/human_operator/crossover_config.hpp"
#include "services/core/rig/parts/body_config.hpp"

namespace stillhand::population {

/// Distributions of a study's subjects: for each quantity a mean and a coefficient of variation
/// (standard deviation over mean), the study's README, "The population".  Every draw is lognormal,
/// so no mass or stiffness is negative, and cut at 2.5 standard deviations of its logarithm,
/// Eq. SU-1.
struct Population {
  double body_mass_kg = 75.0;
  double body_mass_cv = 0.13;
  double seat_frequency_hz = 3.22;
  double seat_frequency_cv = 0.08;
  double seat_damping_ratio = 0.33;
  double seat_damping_cv = 0.15;
  double shoulder_stiffness_n_m = 1160.0;
  double shoulder_stiffness_cv = 0.20;
  double shoulder_damping_ratio = 0.166;
  double shoulder_damping_cv = 0.20;
  double grip_stiffness_n_m = 2400.0;
  double grip_stiffness_cv = 0.20;
  double grip_damping_ratio = 0.10;
  double grip_damping_cv = 0.20;
  double cocontraction_factor = 1.6;
  double cocontraction_cv = 0.10;
  double crossover_hz = 0.337;
  double crossover_cv = 0.15;
  double delay_s = 0.22;
  double delay_cv = 0.08;
  double muscle_rad_s = 13.0;
  double muscle_cv = 0.10;
  double remnant_ratio = 0.0157;
  double remnant_cv = 0.25;
  double regression_error_m = 0.0292;
  double regression_cv = 0.15;
  // What nerves and muscles add, 0: nothing; each with a spread but tremor is a cause in
  // apps/study/explain/causes.cpp.
  double stiffening_by_vibration_s2_m = 0.0;
  double stiffening_by_vibration_cv = 0.0;
  double stiffening_by_motor_n = 0.0;
  double stiffening_by_motor_cv = 0.0;
  double wander = 0.1;
  double wander_cv = 0.3;
  double reflex_stiffness_n_m = 0.0;
  double reflex_stiffness_cv = 0.0;
  double reflex_damping_time_s = 0.125;
  double motor_resistance = 0.0;
  double motor_resistance_cv = 0.0;
  double involuntary_force_n = 0.4;
  double involuntary_force_cv = 0.3;
  double tremor_force_n = 0.03;
  double tremor_force_cv = 0.3;
  double unmeasured_force_n_s2_m = 0.75;
  double unmeasured_force_cv = 0.3;
  double remnant_by_vibration_s2_m = 0.0;
  double remnant_by_vibration_cv = 0.0;
  double delay_by_vibration_s3_m = 0.0;
  double delay_by_vibration_cv = 0.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    const auto spread = [&](const char* name, auto& value) {
      visit(name, value, kSpreads, kSpread);
    };
    visit(
        "body_mass_kg", self.body_mass_kg, Range{40.0, 130.0},
        "[kg] whole subject; trunk 0.40, arm as felt at the hand 0.0147, hand 0.0040 of it, Winter "
        "(2009) table 4.1");
    spread("body_mass_cv", self.body_mass_cv);
    visit("seat_frequency_hz", self.seat_frequency_hz, Range{1.2, 8.0},
          "[Hz] first lateral mode of the trunk on seat and harness; 1.5 to 4 Hz, Fairley and "
          "Griffin (1990); calibrated in this range");
    spread("seat_frequency_cv", self.seat_frequency_cv);
    visit("seat_damping_ratio", self.seat_damping_ratio, Range{0.1, 1.0},
          "[-] of that mode; 0.2 to 0.45, Fairley and Griffin (1990)");
    spread("seat_damping_cv", self.seat_damping_cv);
    visit(
        "shoulder_stiffness_n_m", self.shoulder_stiffness_n_m, Range{200.0, 2500.0},
        "[N/m] shoulder and elbow felt at the idle hand; Mussa-Ivaldi et al. (1985), Perreault et "
        "al. (2002); calibrated");
    spread("shoulder_stiffness_cv", self.shoulder_stiffness_cv);
    visit("shoulder_damping_ratio", self.shoulder_damping_ratio, Range{0.05, 1.0},
          "[-] of the arm's mass on it; 0.1 to 0.4, Perreault et al. (2004)");
    spread("shoulder_damping_cv", self.shoulder_damping_cv);
    visit("grip_stiffness_n_m", self.grip_stiffness_n_m, Range{500.0, 8000.0},
          "[N/m] palm and wrist around the handle, idle hand; Hasser and Cutkosky (2002)");
    spread("grip_stiffness_cv", self.grip_stiffness_cv);
    visit("grip_damping_ratio", self.grip_damping_ratio, Range{0.02, 1.0},
          "[-] of the masses of arm and hand on it; 0.1 to 0.3, Hasser and Cutkosky (2002)");
    spread("grip_damping_cv", self.grip_damping_cv);
    visit("cocontraction_factor", self.cocontraction_factor, Range{1.0, 4.0},
          "[-] stiffness of the tracking arm over the idle one's; 1.2 to 2, Gomi and Osu (1998); "
          "damping goes with its square root");
    spread("cocontraction_cv", self.cocontraction_cv);
    visit("crossover_hz", self.crossover_hz, Range{0.08, 0.6},
          "[Hz] crossover with no fast error; calibrated, README");
    spread("crossover_cv", self.crossover_cv);
    visit("delay_s", self.delay_s, Range{0.18, 0.4},
          "[s] of the whole subject, muscle included; 0.2 to 0.25 s, McRuer and Jex (1967)");
    spread("delay_cv", self.delay_cv);
    visit("muscle_rad_s", self.muscle_rad_s, Range{10.0, 25.0},
          "[rad/s] arm and muscle; 10 to 20 rad/s, McRuer and Jex (1967)");
    spread("muscle_cv", self.muscle_cv);
    visit("remnant_ratio", self.remnant_ratio, Range{0.0, 0.05},
          "[-] noise-to-signal ratio of what is seen; 0.01 to 0.03, Levison, Kleinman and Baron "
          "(1969); calibrated in this range");
    spread("remnant_cv", self.remnant_cv);
    visit("regression_error_m", self.regression_error_m, Range{0.005, 1.0},
          "[m] RMS of fast error that halves the crossover; calibrated, README");
    spread("regression_cv", self.regression_cv);
    added_fields(visit, self);
  }

 private:
  static constexpr Range kSpreads{0.0, 1.0};
  static constexpr const char* kSpread = "[-] standard deviation over mean";

  /// What nerves and muscles add.
  template <typename Visitor, typename Self>
  static void added_fields(Visitor&& visit, Self& self) {
    const auto spread = [&](const char* name, auto& value) {
      visit(name, value, kSpreads, kSpread);
    };
    visit("stiffening_by_vibration_s2_m", self.stiffening_by_vibration_s2_m, Range{-0.3, 2.0},
          "[s^2/m] growth of the tracking arm's stiffness per m/s^2 RMS of platform motion; no "
          "source");
    spread("stiffening_by_vibration_cv", self.stiffening_by_vibration_cv);
    visit("stiffening_by_motor_n", self.stiffening_by_motor_n, Range{0.0, 1.0},
          "[1/N] growth of the same per N RMS of motor force; no source");
    spread("stiffening_by_motor_cv", self.stiffening_by_motor_cv);
    visit("wander", self.wander, Range{0.0, 0.5},
          "[-] standard deviation of the logarithm of the arm's stiffness over time; 0.05 to 0.2 "
          "assumed");
    spread("wander_cv", self.wander_cv);
    visit("reflex_stiffness_n_m", self.reflex_stiffness_n_m, Range{0.0, 1000.0},
          "[N/m] stretch reflex of the tracking arm; to 400 N/m in narrow-band vibration, Abbink "
          "(2006), recalled");
    spread("reflex_stiffness_cv", self.reflex_stiffness_cv);
    visit("reflex_damping_time_s", self.reflex_damping_time_s, Range{0.0, 1.0},
          "[s] damping of that reflex over its stiffness; 50 N s/m over 400 N/m, the same");
    visit("motor_resistance", self.motor_resistance, Range{0.0, 1.0},
          "[-] share of the motor's force that the hand opposes; no source");
    spread("motor_resistance_cv", self.motor_resistance_cv);
    visit("involuntary_force_n", self.involuntary_force_n, Range{0.0, 5.0},
          "[N] RMS of the slow involuntary force; 0.1 to 0.8 N, derived in the rig's README");
    spread("involuntary_force_cv", self.involuntary_force_cv);
    visit("tremor_force_n", self.tremor_force_n, Range{0.0, 2.0},
          "[N] RMS of the tremor force; about 0.03 N, the same");
    spread("tremor_force_cv", self.tremor_force_cv);
    visit("unmeasured_force_n_s2_m", self.unmeasured_force_n_s2_m, Range{0.0, 5.0},
          "[N s^2/m] RMS force from motion that a_y does not show, per m/s^2 RMS; 0.05 to 0.3 of "
          "the feedthrough assumed");
    spread("unmeasured_force_cv", self.unmeasured_force_cv);
    visit("remnant_by_vibration_s2_m", self.remnant_by_vibration_s2_m, Range{0.0, 20.0},
          "[s^2/m] growth of the remnant per m/s^2 RMS of platform motion; direction: Allen, Jex "
          "and Magdaleno (1973)");
    spread("remnant_by_vibration_cv", self.remnant_by_vibration_cv);
    visit("delay_by_vibration_s3_m", self.delay_by_vibration_s3_m, Range{0.0, 0.2},
          "[s^3/m] growth of the delay per m/s^2 RMS; 0.01 to 0.03 assumed");
    spread("delay_by_vibration_cv", self.delay_by_vibration_cv);
  }
};

/// One simulated subject.
struct Subject {
  rig::BodyConfig body;
  human_operator::CrossoverConfig who;  ///< the session sets its seed
};

/// Feel of the stick for a subject who has learnt it, Eq. SU-2: M, B, K of the driving-point
/// impedance of stick and tracking arm at the hand (METHOD of rig, RG-7), by least squares over 0.1
/// to 1 Hz.
/// @param feel  gives the bounds of the force and the scale of the cursor
human_operator::ArmFeel learnt_feel(const rig::BodyConfig& body, const rig::StickConfig& stick,
                                    human_operator::ArmFeel feel = {});

/// The subject in which every quantity has its mean.
Subject mean_subject(const Population& population);

/// Subject `index` of the study with this seed, Eq. SU-1.  It does not depend on other draws.
/// @param base   gives what no population draws: an arm rest, delays of nerves, bounds of the force
/// @param stick  that the subject has learnt
/// @throws stillhand::ConfigError when the population's fields are out of range.
Subject draw_subject(const Population& population, std::uint64_t seed, std::int64_t index,
                     const Subject& base = {}, const rig::StickConfig& stick = {});

}  // namespace stillhand::population
