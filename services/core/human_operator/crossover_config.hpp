// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/human_operator/arm_feel.hpp"

namespace stillhand::human_operator {

/// One simulated subject; README, "Where the numbers come from".
struct CrossoverConfig {
  std::int64_t seed = 1;
  double crossover_hz = 0.337;
  double delay_s = 0.22;
  double muscle_rad_s = 13.0;
  double muscle_damping_ratio = 0.7;
  double regression_error_m = 0.0292;
  double regression_above_hz = 0.5;
  double regression_memory_s = 4.0;
  double remnant_ratio = 0.0157;
  double remnant_floor_m = 0.001;
  double remnant_by_vibration_s2_m = 0.0;
  double delay_by_vibration_s3_m = 0.0;
  ArmFeel arm;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("seed", self.seed, Range{0.0, 4294967295.0}, "[-] seed of the subject's remnant");
    visit("crossover_hz", self.crossover_hz, Range{0.02, 1.0},
          "[Hz] crossover frequency without fast error, w_c0 / 2 pi; paper Table I (0.25 Hz, "
          "condition A)");
    visit("delay_s", self.delay_s, Range{0.05, 0.6},
          "[s] T_d of the whole subject, including the lag of the muscle; 0.2 to 0.25 s, McRuer "
          "and Jex (1967)");
    visit("muscle_rad_s", self.muscle_rad_s, Range{4.0, 40.0},
          "[rad/s] w_n of arm and muscle; 10 to 20 rad/s, McRuer and Jex (1967)");
    visit("muscle_damping_ratio", self.muscle_damping_ratio, Range{0.1, 0.95},
          "[-] z of arm and muscle; McRuer and Jex (1967)");
    visit("regression_error_m", self.regression_error_m, Range{0.001, 1e6},
          "[m] E_0, RMS fast error that halves the crossover frequency; README, Eq. HO-5");
    visit("regression_above_hz", self.regression_above_hz, Range{0.05, 5.0},
          "[Hz] frequency above which an error counts as fast; README, Eq. HO-5");
    visit("regression_memory_s", self.regression_memory_s, Range{0.5, 60.0},
          "[s] time constant of the mean square of the fast error; README, Eq. HO-5");
    visit("remnant_ratio", self.remnant_ratio, Range{0.0, 0.2},
          "[-] noise-to-signal ratio of the seen error, 0.01 is -20 dB; Levison, Kleinman and "
          "Baron (1969)");
    visit(
        "remnant_floor_m", self.remnant_floor_m, Range{0.0, 0.02},
        "[m] RMS error below which the remnant stays constant; assumed, about the width of a line");
    visit("remnant_by_vibration_s2_m", self.remnant_by_vibration_s2_m, Range{0.0, 20.0},
          "[s^2/m] growth of remnant_ratio per m/s^2 RMS of platform motion; README, Eq. HO-7");
    visit("delay_by_vibration_s3_m", self.delay_by_vibration_s3_m, Range{0.0, 0.2},
          "[s^3/m] growth of delay_s per m/s^2 RMS of platform motion; README, Eq. HO-7");
    visit.group("arm", self.arm);
  }
};

}  // namespace stillhand::human_operator
