// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/admittance/arm_model.hpp"
#include "services/core/cancellation/parts/stick_impedance.hpp"
#include "services/core/signal/difference_model.hpp"

/// Parameters by optimisation over a population of fitted arms, before a session.  Nothing here
/// looks at a trial.
namespace stillhand::study {

/// Where a motion or a wanted motion has its power.
struct PowerLine {
  double frequency_hz;
  double power;  ///< any unit, the same for all lines
};

/// One person: arms of two tasks, and models of falling order from one identification.
struct KnownPerson {
  std::vector<admittance::ArmValues> arms = {};       ///< relaxed, holding
  std::vector<signal::DifferenceModel> reduced = {};  ///< by order from 1 on, at 1 kHz
};

struct ReducedChoice {
  std::size_t order = 0;  ///< of the model
  double gain = 0.0;      ///< g
  double worst = 0.0;     ///< share of the motion that is left in the worst case
};

/// Reduced model for people whom it was not made for, METHOD Eq. MI-7: order p and gain g with the
/// least worst case, over every person i, task t and person j whose model is used,
///
///   min_{p,g} max_{i,t,j}  || P_it (H_it - g H^_jp) A || / || P_it H_it A ||
///
/// H_it and P_it: fitted arm of i in task t on the free stick, A: the motion.  Gains are tried from
/// 0 to 1.2 in steps of 0.05; 0 is no cancellation, so the worst case is never above 1.
/// @throws stillhand::ConfigError when there is nobody, or nobody has a model.
ReducedChoice choose_reduced(const std::vector<KnownPerson>& people,
                             const std::vector<PowerLine>& motion,
                             const admittance::StickValues& stick);

/// What stands between the stick's sensor and the motor's force.
struct LoopTiming {
  double rate_filter_hz = 30.0;  ///< of sensing: second-order Butterworth on the speed
  double delay_s = 0.0005;       ///< half a tick of hold
  double lag_s = 0.0015;         ///< of the motor
};

struct ImpedanceChoice {
  cancellation::ImpedanceConfig impedance = {};
  double worst = 0.0;       ///< motion that is left in the worst arm, over that without
  double effort = 0.0;      ///< largest force for the wanted motion, over that without
  double passive_hz = 0.0;  ///< the shaped stick gives off no energy below this frequency
};

struct ImpedanceBounds {
  double most_effort = 1.5;        ///< own choice: half as much force again
  double passive_to_hz = 10.0;     ///< above what reflexes follow
  double most_stiffness = 1500.0;  ///< [N/m]
  double most_damping = 60.0;      ///< [N s/m]
  double most_mass = 0.8;          ///< [kg]
};

/// Shaped stick, METHOD Eq. MI-8: K, B, M of Eq. MI-2 with the least worst case
///
///   min max_{i,t} || H_it/(Z_s + Z_+ + Z_it) A || / || H_it/(Z_s + Z_it) A ||
///
/// where Z_+ = D (K + B s L + M s^2 L L_M), D delay and lag of the loop, L the rate filter, L_M the
/// lag of Eq. MI-2; subject to || (Z_s + Z_+ + Z_it) R || <= most_effort || (Z_s + Z_it) R ||, R
/// the wanted motion, and Re((Z_s + Z_+)/s) >= 0 up to passive_to_hz.  By search on a grid.
/// @throws stillhand::ConfigError when there is nobody.
ImpedanceChoice choose_impedance(const std::vector<KnownPerson>& people,
                                 const std::vector<PowerLine>& motion,
                                 const std::vector<PowerLine>& wanted,
                                 const admittance::StickValues& stick,
                                 const LoopTiming& timing = {}, const ImpedanceBounds& bounds = {});

/// Lowest frequency [Hz], in steps of 0.1 Hz to 100 Hz, at which the shaped stick gives off energy,
/// Re((Z_s + Z_+)/s) < 0; 100 where there is none.
double passive_up_to_hz(const cancellation::ImpedanceConfig& impedance,
                        const admittance::StickValues& stick, const LoopTiming& timing = {});

}  // namespace stillhand::study
