// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/chain.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/MatrixFunctions>

namespace stillhand::rig {
namespace {

using Square = Eigen::Matrix<double, 6, 6>;
using Column = Eigen::Matrix<double, 6, 1>;

/// Eq. RG-3 and RG-4 as dx/dt = A x + B a + G u.
struct Continuous {
  Square a_matrix = Square::Zero();
  Column b_column = Column::Zero();
  Column g_column = Column::Zero();
};

/// A spring and damper between the masses whose positions are at `i` and `j`.
void connect(Square& a_matrix, Eigen::Index i, Eigen::Index j, double mass_i_kg, double mass_j_kg,
             double stiffness_n_m, double damping_n_s_m) {
  const auto pull = [&](Eigen::Index on, Eigen::Index to, double mass_kg) {
    a_matrix(on + 1, on) -= stiffness_n_m / mass_kg;
    a_matrix(on + 1, to) += stiffness_n_m / mass_kg;
    a_matrix(on + 1, on + 1) -= damping_n_s_m / mass_kg;
    a_matrix(on + 1, to + 1) += damping_n_s_m / mass_kg;
  };
  pull(i, j, mass_i_kg);
  pull(j, i, mass_j_kg);
}

Continuous continuous(const ChainParameters& p) {
  Continuous system;
  Square& a = system.a_matrix;
  a(kTrunk, kTrunkRate) = a(kArm, kArmRate) = a(kStick, kStickRate) = 1.0;
  a(kTrunkRate, kTrunk) -= p.seat_stiffness_n_m / p.trunk_mass_kg;
  a(kTrunkRate, kTrunkRate) -= p.seat_damping_n_s_m / p.trunk_mass_kg;
  connect(a, kTrunk, kArm, p.trunk_mass_kg, p.arm_mass_kg, p.shoulder_stiffness_n_m,
          p.shoulder_damping_n_s_m);
  connect(a, kArm, kStick, p.arm_mass_kg, p.stick_mass_kg, p.grip_stiffness_n_m,
          p.grip_damping_n_s_m);
  a(kArmRate, kArm) -= p.arm_rest_stiffness_n_m / p.arm_mass_kg;
  a(kArmRate, kArmRate) -= p.arm_rest_damping_n_s_m / p.arm_mass_kg;
  a(kStickRate, kStick) -= p.centring_stiffness_n_m / p.stick_mass_kg;
  a(kStickRate, kStickRate) -= p.viscous_damping_n_s_m / p.stick_mass_kg;
  system.b_column(kTrunkRate) = system.b_column(kArmRate) = -1.0;
  system.b_column(kStickRate) = -p.cell_mass_kg / p.stick_mass_kg;
  system.g_column(kStickRate) = 1.0 / p.stick_mass_kg;
  return system;
}

/// Eq. RG-10 for the first N states: matrix exponential of the system, extended by acceleration,
/// slope of the acceleration and force.
template <std::size_t N>
LinearStep<N> discretised(const Continuous& system, double period_s) {
  constexpr Eigen::Index kN = static_cast<Eigen::Index>(N);
  using Extended = Eigen::Matrix<double, kN + 3, kN + 3>;
  Extended rate = Extended::Zero();
  rate.template topLeftCorner<kN, kN>() = system.a_matrix.topLeftCorner<kN, kN>();
  rate.template block<kN, 1>(0, kN) = system.b_column.head<kN>();
  rate.template block<kN, 1>(0, kN + 2) = system.g_column.head<kN>();
  rate(kN, kN + 1) = 1.0;
  const Extended flow = (rate * period_s).exp();

  LinearStep<N> step;
  for (Eigen::Index i = 0; i < kN; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < kN; ++j) {
      step.phi_columns[static_cast<std::size_t>(j)][row] = flow(i, j);
    }
    step.from_now[row] = flow(i, kN + 1) / period_s;
    step.from_last[row] = flow(i, kN) - step.from_now[row];
    step.from_force[row] = flow(i, kN + 2);
  }
  return step;
}

template <std::size_t N>
ForceColumns<N> force_columns(const ChainParameters& parameters, double period_s) {
  Continuous system = continuous(parameters);
  ForceColumns<N> columns;
  system.g_column = Column::Unit(kTrunkRate) / parameters.trunk_mass_kg;
  columns.trunk = discretised<N>(system, period_s).from_force;
  system.g_column = Column::Unit(kArmRate) / parameters.arm_mass_kg;
  columns.arm = discretised<N>(system, period_s).from_force;
  return columns;
}

}  // namespace

ChainParameters chain_parameters(const BodyConfig& body, const StickConfig& stick, bool relaxed) {
  const double stiffer = relaxed ? 1.0 : body.cocontraction_stiffness_factor;
  const double damper = relaxed ? 1.0 : body.cocontraction_damping_factor;
  const double cell_mass_kg = body.hand_mass_kg + stick.handle_mass_kg;
  return {.trunk_mass_kg = body.trunk_mass_kg,
          .seat_stiffness_n_m = body.seat_stiffness_n_m,
          .seat_damping_n_s_m = body.seat_damping_n_s_m,
          .arm_mass_kg = body.arm_mass_kg,
          .shoulder_stiffness_n_m = body.shoulder_stiffness_n_m * stiffer,
          .shoulder_damping_n_s_m = body.shoulder_damping_n_s_m * damper,
          .arm_rest_stiffness_n_m = body.arm_rest_stiffness_n_m,
          .arm_rest_damping_n_s_m = body.arm_rest_damping_n_s_m,
          .grip_stiffness_n_m = body.grip_stiffness_n_m * stiffer,
          .grip_damping_n_s_m = body.grip_damping_n_s_m * damper,
          .cell_mass_kg = cell_mass_kg,
          .stick_mass_kg = cell_mass_kg + stick.drive_mass_kg,
          .viscous_damping_n_s_m = stick.viscous_damping_n_s_m,
          .centring_stiffness_n_m = stick.centring_stiffness_n_m};
}

HeldChain held_chain(const ChainParameters& parameters, double period_s) {
  return discretised<4>(continuous(parameters), period_s);
}

FreeChain free_chain(const ChainParameters& parameters, double period_s) {
  return discretised<6>(continuous(parameters), period_s);
}

ForceColumns<4> held_force_columns(const ChainParameters& parameters, double period_s) {
  return force_columns<4>(parameters, period_s);
}

ForceColumns<6> free_force_columns(const ChainParameters& parameters, double period_s) {
  return force_columns<6>(parameters, period_s);
}

}  // namespace stillhand::rig
