// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <string_view>

namespace stillhand::admittance {

/// Number of a parameter in ArmValues.
enum ArmParameter : std::size_t {
  kTrunkMass,        ///< m_t [kg] on the seat
  kSeatDamping,      ///< c_t [N s/m]
  kSeatStiffness,    ///< k_t [N/m]
  kArmMass,          ///< m_a [kg] felt at the hand
  kArmDamping,       ///< c_a [N s/m] shoulder and elbow, with the muscles' activation
  kArmStiffness,     ///< k_a [N/m]
  kCellMass,         ///< m_c [kg] hand and handle, above the load cell
  kGripDamping,      ///< c_h [N s/m]
  kGripStiffness,    ///< k_h [N/m]
  kReflexStiffness,  ///< k_r [N/m] stretch reflex: force per stretch
  kReflexDamping,    ///< c_r [N s/m] the same: force per speed of stretch
  kReflexDelay,      ///< tau [s] of the nerves
  kMuscleFrequency,  ///< f_m [Hz] of the muscle's activation
  kArmParameters
};

/// Values of an arm in the order of ArmParameter.
using ArmValues = std::array<double, kArmParameters>;

struct ArmParameterName {
  std::string_view name;  ///< with its unit, as in JSON
  std::string_view unit;
};
/// In the order of ArmParameter.
const std::array<ArmParameterName, kArmParameters>& arm_parameter_names() noexcept;

/// Damping ratio of the muscle's activation; the data do not tell it from its frequency.
inline constexpr double kMuscleDamping = 0.75;

/// The stick below the load cell.
struct StickValues {
  double drive_mass_kg = 0.25;          ///< m_d
  double viscous_damping_n_s_m = 0.5;   ///< b
  double centring_stiffness_n_m = 0.0;  ///< k_c
};

/// The arm at one frequency: force of the hand through the load cell F = H A - Z X.
struct ArmResponse {
  std::complex<double> impedance;    ///< Z [N/m], 1/admittance
  std::complex<double> feedthrough;  ///< H [N s^2/m], stick held
};

/// Trunk on seat, arm with reflex, grip, Eqs. AD-9 and AD-10:
///
///   D_t = m_t s^2 + c_t s + k_t + K_a,   K_a = k_a + c_a s + R,   K_h = k_h + c_h s
///   D_a = m_a s^2 + K_a + K_h,           R = (k_r + c_r s) exp(-s tau) / (1 + 2 z s/w + s^2/w^2)
///   Z = m_c s^2 + K_h - K_h^2 D_t/(D_t D_a - K_a^2)
///   H = -m_c - K_h (m_a D_t + m_t K_a)/(D_t D_a - K_a^2)
///
/// Source: README; services/processes/rig RG-3, RG-5, RG-6 and RG-29.  Pure.
ArmResponse arm_response(const ArmValues& arm, double frequency_hz) noexcept;

/// What a free stick shows, Eq. AD-11, with Z_s = m_d s^2 + b s + k_c.
struct FreeStickResponse {
  std::complex<double> stick_per_force;          ///< X/F_m = 1/(Z_s + Z) [m/N]
  std::complex<double> feedthrough_to_position;  ///< X/A = H/(Z_s + Z) [s^2]
  std::complex<double> feedthrough_to_force;     ///< F/A = Z_s X/A [N s^2/m]
};
FreeStickResponse free_stick(const ArmResponse& arm, const StickValues& stick,
                             double frequency_hz) noexcept;

}  // namespace stillhand::admittance
