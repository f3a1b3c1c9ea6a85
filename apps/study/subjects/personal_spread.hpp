// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/libraries/session/in_process.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::study {

/// What differs between the trials of one person and between people, besides the population; METHOD
/// Eq. SU-23.  Standard deviations of a logarithm unless said otherwise; as it stands, nothing.
struct PersonalSpread {
  // The hand on the peg over the same person's hand in the tracking trials.
  double pegged_stiffness = 0.0;  ///< shoulder and grip, over people
  double pegged_grip = 0.0;       ///< grip alone, over people
  double pegged_posture = 0.0;    ///< mass and stiffness of the arm, each, over people
  double pegged_noise = 1.0;      ///< factor on the forces that the model cannot explain
  // Skill: crossover and regression error times it, remnant over it.
  double learning = 0.0;     ///< growth of ln skill from trial to trial, over people
  double trial_skill = 0.0;  ///< over all trials
  double motor_skill = 0.0;  ///< with the motor, over people
  double motor_gain = 0.0;   ///< over people
  /// Another one repeats the tracking trials: the same person, model, and habits.
  std::uint64_t visit = 0;
};

/// One person's draws.
class PersonalTrials {
 public:
  PersonalTrials(const PersonalSpread& spread, std::uint64_t seed, std::int64_t index);

  /// Changes the settings of one trial.
  void change(const session::PlannedTrial& planned, session::CoreConfigs& configs) const;
  /// Of the rig and the operator of one trial: its noise is its own.
  [[nodiscard]] std::uint64_t loop_seed(const session::PlannedTrial& planned,
                                        std::uint64_t session_seed) const;

 private:
  /// Which trial of the person: the pegged one is the same in every visit.
  [[nodiscard]] std::uint64_t at(const session::PlannedTrial& planned) const;
  void peg(session::CoreConfigs& configs) const;

  PersonalSpread spread_;
  std::uint64_t seed_;
  std::uint64_t stream_;
  double stiffness_;
  double grip_;
  double mass_;
  double shoulder_;
  double learning_;
  double motor_skill_;
  double gain_;
};

}  // namespace stillhand::study
