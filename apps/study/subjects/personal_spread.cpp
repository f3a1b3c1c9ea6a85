// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/personal_spread.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/clamp_fields.hpp"

namespace stillhand::study {
namespace {

// Streams of the draws under the study's seed; the person's index and the trial are added.
constexpr std::uint64_t kPersonStream = 0x70657273'00000000;
constexpr std::uint64_t kTrialsOfAPerson = 1000;
constexpr std::uint64_t kTrialsOfAVisit = 100;
constexpr double kFarthestDraw = 2.5;  // Eq. SU-1

double deviate(signal::Gaussian& normal) {
  double z = normal();
  while (std::abs(z) > kFarthestDraw) z = normal();
  return z;
}

void skilled(double log_skill, human_operator::CrossoverConfig& who) {
  who.crossover_hz *= std::exp(log_skill);
  who.regression_error_m *= std::exp(log_skill);
  who.remnant_ratio *= std::exp(-log_skill);
}

}  // namespace

PersonalTrials::PersonalTrials(const PersonalSpread& spread, std::uint64_t seed, std::int64_t index)
    : spread_(spread),
      seed_(seed),
      stream_(kPersonStream + static_cast<std::uint64_t>(index) * kTrialsOfAPerson) {
  signal::Gaussian normal(seed_, stream_);
  for (double* z : {&stiffness_, &grip_, &mass_, &shoulder_, &learning_, &motor_skill_, &gain_}) {
    *z = deviate(normal);
  }
}

std::uint64_t PersonalTrials::at(const session::PlannedTrial& planned) const {
  const bool pegged = planned.trial.phase == TrialPhase::kPegged;
  return 1 + static_cast<std::uint64_t>(planned.trial.number) +
         (pegged ? 0 : kTrialsOfAVisit * spread_.visit);
}

std::uint64_t PersonalTrials::loop_seed(const session::PlannedTrial& planned,
                                        std::uint64_t session_seed) const {
  return session::repeat_seed(session_seed, at(planned));
}

void PersonalTrials::peg(session::CoreConfigs& configs) const {
  rig::BodyConfig& body = configs.rig.body;
  const double both = std::exp(spread_.pegged_stiffness * stiffness_);
  body.shoulder_stiffness_n_m *= both * std::exp(spread_.pegged_posture * shoulder_);
  body.grip_stiffness_n_m *= both * std::exp(spread_.pegged_grip * grip_);
  body.arm_mass_kg *= std::exp(spread_.pegged_posture * mass_);
  // As with co-contraction: the damping goes with the root of the stiffness.
  body.shoulder_damping_n_s_m *= std::sqrt(both);
  body.grip_damping_n_s_m *= std::sqrt(both);
  rig::NeuromuscularConfig& nerves = body.neuromuscular;
  nerves.involuntary_force_n *= spread_.pegged_noise;
  nerves.unmeasured_force_n_s2_m *= spread_.pegged_noise;
  settings::clamp_fields(nerves);
}

void PersonalTrials::change(const session::PlannedTrial& planned,
                            session::CoreConfigs& configs) const {
  if (planned.trial.phase == TrialPhase::kPegged) {
    peg(configs);
    return;
  }
  signal::Gaussian normal(seed_, stream_ + at(planned));
  // About the second of three tracking trials: the mean skill stays.
  double log_skill =
      spread_.learning * learning_ * (static_cast<double>(planned.trial.number) - 2.0) +
      spread_.trial_skill * deviate(normal);
  if (planned.cancellation) log_skill += spread_.motor_skill * motor_skill_;
  skilled(log_skill, configs.human_operator);
  configs.rig.motor.gain =
      std::min(configs.rig.motor.gain * std::exp(spread_.motor_gain * gain_), 2.0);
}

}  // namespace stillhand::study
