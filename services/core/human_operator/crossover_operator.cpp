// SPDX-License-Identifier: Apache-2.0
#include "services/core/human_operator/crossover_operator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::human_operator {
namespace {

// Stream of the remnant under the subject's seed; the trial's number is added.
constexpr std::uint64_t kRemnantStream = 0x72656d6e616e7400;
// Eq. HO-7: memory of the felt vibration, and the largest RMS that counts.
constexpr double kFelt_s = 4.0;
constexpr double kMostFelt_m_s2 = 5.0;
// A larger acceleration in a message is no motion of a platform; it is clipped.
constexpr double kFarthestFelt_m_s2 = 60.0;
// Wider than any screen; larger positions in a message are clipped.
constexpr double kFarthestSeen_m = 1.0;

const CrossoverConfig& checked(const CrossoverConfig& config) {
  validate(config, "human_operator");
  const double muscle_lag_s = 2.0 * config.muscle_damping_ratio / config.muscle_rad_s;
  if (config.delay_s < muscle_lag_s) {
    throw ConfigError("human_operator.delay_s", std::to_string(config.delay_s),
                      "at least the muscle's lag 2 z / w_n = " + std::to_string(muscle_lag_s));
  }
  return config;
}

/// T_p in ticks: T_d without the lag of the muscle.
std::size_t perception_ticks(const CrossoverConfig& config) {
  const double muscle_lag_s = 2.0 * config.muscle_damping_ratio / config.muscle_rad_s;
  return static_cast<std::size_t>(ticks_in(config.delay_s - muscle_lag_s));
}

Remnant remnant(const CrossoverConfig& config, std::int64_t trial_number) {
  return Remnant(config.remnant_ratio, config.remnant_floor_m,
                 static_cast<std::uint64_t>(config.seed),
                 kRemnantStream + static_cast<std::uint64_t>(trial_number));
}

/// The wanted displacement is bounded by the displacement that max_force_n can hold against K.
double reach(const ArmFeel& arm) {
  const double held_m = arm.max_force_n / std::max(arm.effective_stiffness_n_m, 1e-9);
  return std::min(kFarthestSeen_m, arm.cursor_per_hand * held_m);
}

}  // namespace

CrossoverOperator::CrossoverOperator(const Config& config)
    : config_(checked(config)),
      reach_m_(reach(config.arm)),
      perception_ticks_(perception_ticks(config)),
      delay_(perception_ticks_ +
             static_cast<std::size_t>(ticks_in(config.delay_by_vibration_s3_m * kMostFelt_m_s2))),
      vibration_m_s2_(kFelt_s),
      fast_error_(config.regression_above_hz, config.regression_memory_s),
      remnant_(remnant(config, 0)),
      muscle_(config.muscle_rad_s, config.muscle_damping_ratio, kControlPeriod_s),
      envelope_(force_envelope(config.arm)),
      crossover_rad_s_(2.0 * std::numbers::pi * config.crossover_hz) {}

void CrossoverOperator::arm(const Trial& trial) {
  start_afresh();
  remnant_ = remnant(config_, trial.number);
  last_tick_ = -1;
}

void CrossoverOperator::start_afresh() noexcept {
  if (rested_) return;
  rested_ = true;
  delay_.reset();
  vibration_m_s2_.reset();
  fast_error_.reset();
  muscle_.reset();
  wanted_m_ = 0.0;
  crossover_rad_s_ = 2.0 * std::numbers::pi * config_.crossover_hz;
}

double CrossoverOperator::wanted_force(double error_m, double felt_m_s2) noexcept {
  rested_ = false;
  vibration_m_s2_.step(felt_m_s2);
  const double vibration_m_s2 = std::min(vibration_m_s2_.value(), kMostFelt_m_s2);
  const auto perceived_ticks =
      perception_ticks_ +
      static_cast<std::size_t>(ticks_in(config_.delay_by_vibration_s3_m * vibration_m_s2));
  fast_error_.step(error_m);
  const double e0_m2 = config_.regression_error_m * config_.regression_error_m;
  crossover_rad_s_ =
      2.0 * std::numbers::pi * config_.crossover_hz / (1.0 + fast_error_.mean_square_m2() / e0_m2);
  const double growth = 1.0 + config_.remnant_by_vibration_s2_m * vibration_m_s2;
  const double seen_m = delay_.step(error_m, perceived_ticks) + remnant_.step(error_m, growth);
  wanted_m_ =
      std::clamp(wanted_m_ + crossover_rad_s_ * seen_m * kControlPeriod_s, -reach_m_, reach_m_);
  const auto hand = muscle_.step(wanted_m_ / config_.arm.cursor_per_hand);
  return config_.arm.force(hand.x, hand.v, hand.a);
}

OperatorOutput CrossoverOperator::step(const OperatorInput& input) noexcept {
  Flags flags = kGood;
  if (last_tick_ >= 0 && input.tick != last_tick_ + 1) flags |= kInputGap;
  last_tick_ = input.tick;

  const double error_m = input.target_m - input.cursor_m;
  const bool seen = std::isfinite(error_m);
  if (!seen) flags |= kInputInvalid;
  double force_n = 0.0;
  if (input.active && seen) {
    const double felt_m_s2 =
        std::isfinite(input.felt_m_s2)
            ? std::clamp(input.felt_m_s2, -kFarthestFelt_m_s2, kFarthestFelt_m_s2)
            : 0.0;
    force_n = wanted_force(std::clamp(error_m, -kFarthestSeen_m, kFarthestSeen_m), felt_m_s2);
  } else if (!input.active) {
    start_afresh();
  }
  auto out = envelope_.step(force_n, input.active && seen);
  return {out.force_n, out.flags | flags};
}

double CrossoverOperator::crossover_hz() const noexcept {
  return crossover_rad_s_ / (2.0 * std::numbers::pi);
}

}  // namespace stillhand::human_operator
