// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/arm_model.hpp"

#include "services/core/contract/units.hpp"

namespace stillhand::admittance {

using Complex = std::complex<double>;

const std::array<ArmParameterName, kArmParameters>& arm_parameter_names() noexcept {
  static constexpr std::array<ArmParameterName, kArmParameters> kNames{
      {{"trunk_mass_kg", "kg"},
       {"seat_damping_n_s_m", "N s/m"},
       {"seat_stiffness_n_m", "N/m"},
       {"arm_mass_kg", "kg"},
       {"arm_damping_n_s_m", "N s/m"},
       {"arm_stiffness_n_m", "N/m"},
       {"cell_mass_kg", "kg"},
       {"grip_damping_n_s_m", "N s/m"},
       {"grip_stiffness_n_m", "N/m"},
       {"reflex_stiffness_n_m", "N/m"},
       {"reflex_damping_n_s_m", "N s/m"},
       {"reflex_delay_s", "s"},
       {"muscle_frequency_hz", "Hz"}}};
  return kNames;
}

ArmResponse arm_response(const ArmValues& arm, double frequency_hz) noexcept {
  const Complex s(0.0, kTwoPi * frequency_hz);
  const double w = kTwoPi * arm[kMuscleFrequency];
  const Complex reflex = (arm[kReflexStiffness] + arm[kReflexDamping] * s) *
                         std::exp(-s * arm[kReflexDelay]) /
                         (1.0 + 2.0 * kMuscleDamping * s / w + s * s / (w * w));
  const Complex shoulder = arm[kArmStiffness] + arm[kArmDamping] * s + reflex;
  const Complex grip = arm[kGripStiffness] + arm[kGripDamping] * s;
  const Complex trunk =
      arm[kTrunkMass] * s * s + arm[kSeatDamping] * s + arm[kSeatStiffness] + shoulder;
  const Complex middle = arm[kArmMass] * s * s + shoulder + grip;
  const Complex determinant = trunk * middle - shoulder * shoulder;
  return {.impedance = arm[kCellMass] * s * s + grip - grip * grip * trunk / determinant,
          .feedthrough = -arm[kCellMass] -
                         grip * (arm[kArmMass] * trunk + arm[kTrunkMass] * shoulder) / determinant};
}

FreeStickResponse free_stick(const ArmResponse& arm, const StickValues& stick,
                             double frequency_hz) noexcept {
  const Complex s(0.0, kTwoPi * frequency_hz);
  const Complex of_stick =
      stick.drive_mass_kg * s * s + stick.viscous_damping_n_s_m * s + stick.centring_stiffness_n_m;
  FreeStickResponse out;
  out.stick_per_force = 1.0 / (of_stick + arm.impedance);
  out.feedthrough_to_position = arm.feedthrough * out.stick_per_force;
  out.feedthrough_to_force = of_stick * out.feedthrough_to_position;
  return out;
}

}  // namespace stillhand::admittance
