// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "services/core/contract/tick.hpp"
#include "services/core/rig/parts/body_config.hpp"

namespace stillhand::rig {

/// Parameters of the linear chain in one state of the muscles, Eq. RG-3.
struct ChainParameters {
  double trunk_mass_kg, seat_stiffness_n_m, seat_damping_n_s_m;
  double arm_mass_kg, shoulder_stiffness_n_m, shoulder_damping_n_s_m;
  double arm_rest_stiffness_n_m, arm_rest_damping_n_s_m;
  double grip_stiffness_n_m, grip_damping_n_s_m;
  double cell_mass_kg;   ///< m_0 = hand + handle, above the load cell
  double stick_mass_kg;  ///< M = m_0 + m_d, everything that moves with the hand
  double viscous_damping_n_s_m, centring_stiffness_n_m;
};

/// @param relaxed  true: idle hand;  false: co-contraction factors applied
ChainParameters chain_parameters(const BodyConfig& body, const StickConfig& stick, bool relaxed);

/// Exact step of dx/dt = A x + B a(t) + G u over one tick, with a(t) linear between its samples and
/// u constant:
///
///   x[n] = Phi x[n-1] + B0 a[n-1] + B1 a[n] + G u[n]
///
/// Source: METHOD Eq. RG-10; Franklin, Powell and Workman, Digital Control of Dynamic Systems, 3rd
/// ed., section 6.3.
template <std::size_t N>
struct LinearStep {
  using State = std::array<double, N>;
  std::array<State, N> phi_columns{};  ///< Phi by columns
  State from_last{};                   ///< B0
  State from_now{};                    ///< B1
  State from_force{};                  ///< G

  [[nodiscard]] State step(const State& x, double a_last, double a_now,
                           double force_n) const noexcept {
    State next;
    for (std::size_t i = 0; i < N; ++i) {
      next[i] = from_last[i] * a_last + from_now[i] * a_now + from_force[i] * force_n;
    }
    for (std::size_t j = 0; j < N; ++j) {
      for (std::size_t i = 0; i < N; ++i) next[i] += phi_columns[j][i] * x[j];
    }
    return next;
  }
};

/// Stick held at 0.  State: trunk position, trunk velocity, arm position, arm velocity [m, m/s].
using HeldChain = LinearStep<4>;
/// Stick free.  State: as HeldChain, then stick position and velocity at the hand [m, m/s]; the
/// force acts on the stick.
using FreeChain = LinearStep<6>;

/// Index of a quantity in a State.
enum ChainIndex : std::size_t { kTrunk = 0, kTrunkRate, kArm, kArmRate, kStick, kStickRate };

HeldChain held_chain(const ChainParameters& parameters, double period_s);
FreeChain free_chain(const ChainParameters& parameters, double period_s);

/// Change of the state at the end of a tick for a constant force of 1 N on a mass: G of Eq. RG-10
/// for trunk and arm.
template <std::size_t N>
struct ForceColumns {
  std::array<double, N> trunk{};
  std::array<double, N> arm{};
};
ForceColumns<4> held_force_columns(const ChainParameters& parameters, double period_s);
ForceColumns<6> free_force_columns(const ChainParameters& parameters, double period_s);

}  // namespace stillhand::rig
