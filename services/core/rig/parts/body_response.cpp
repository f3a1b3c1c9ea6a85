// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/body_response.hpp"

#include <numbers>

#include "services/core/contract/expects.hpp"
#include "services/core/rig/parts/chain.hpp"

namespace stillhand::rig {
namespace {

using Complex = std::complex<double>;

/// Dynamic stiffnesses of the chain at one frequency [N/m].
struct DynamicStiffness {
  Complex s;
  Complex shoulder, grip;  ///< K_a, K_h
  Complex trunk, arm;      ///< D_t, D_a: diagonal of the chain's matrix
  Complex determinant;     ///< D_t D_a - K_a^2
};

DynamicStiffness dynamic_stiffness(const ChainParameters& p, double frequency_hz) {
  STILLHAND_EXPECTS(frequency_hz >= 0.0);
  DynamicStiffness k;
  k.s = Complex(0.0, 2.0 * std::numbers::pi * frequency_hz);
  k.shoulder = p.shoulder_stiffness_n_m + k.s * p.shoulder_damping_n_s_m;
  k.grip = p.grip_stiffness_n_m + k.s * p.grip_damping_n_s_m;
  k.trunk =
      p.trunk_mass_kg * k.s * k.s + p.seat_stiffness_n_m + k.s * p.seat_damping_n_s_m + k.shoulder;
  const Complex arm_rest = p.arm_rest_stiffness_n_m + k.s * p.arm_rest_damping_n_s_m;
  k.arm = p.arm_mass_kg * k.s * k.s + k.shoulder + k.grip + arm_rest;
  k.determinant = k.trunk * k.arm - k.shoulder * k.shoulder;
  return k;
}

}  // namespace

Complex feedthrough_response(const BodyConfig& body, const StickConfig& stick, bool relaxed,
                             double frequency_hz) {
  const auto p = chain_parameters(body, stick, relaxed);
  const auto k = dynamic_stiffness(p, frequency_hz);
  const Complex arm_m = -(p.arm_mass_kg * k.trunk + p.trunk_mass_kg * k.shoulder) / k.determinant;
  return k.grip * arm_m - p.cell_mass_kg;
}

Complex hand_admittance(const BodyConfig& body, const StickConfig& stick, bool relaxed,
                        double frequency_hz) {
  const auto p = chain_parameters(body, stick, relaxed);
  const auto k = dynamic_stiffness(p, frequency_hz);
  const Complex of_stick =
      p.stick_mass_kg * k.s * k.s + k.s * p.viscous_damping_n_s_m + p.centring_stiffness_n_m;
  const Complex of_body = k.grip - k.grip * k.grip * k.trunk / k.determinant;
  return 1.0 / (of_stick + of_body);
}

}  // namespace stillhand::rig
