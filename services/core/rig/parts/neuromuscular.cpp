// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/neuromuscular.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::rig {
namespace {

// Streams under the seed of the rig.
constexpr std::uint64_t kWanderStream = 0x77616e646572;
constexpr std::uint64_t kInvoluntaryStream = 0x696e766f6c;
constexpr std::uint64_t kTremorStream = 0x7472656d6f72;
constexpr std::uint64_t kUnmeasuredStream = 0x756e6d6561;
// [s] Memory of the felt vibration and the felt motor force.
constexpr double kFelt_s = 4.0;
// Eq. RG-27: the stiffness does not fall below 0.45 of its value.
constexpr double kMostSoftening = -0.55;
// Eq. RG-32: band of the tracking motion, paper III-C.
constexpr double kUnmeasuredLow_hz = 0.7;
constexpr double kUnmeasuredHigh_hz = 2.0;

std::optional<BandNoise> noise(std::uint64_t seed, std::uint64_t stream,
                               const BandNoise::Band& band) {
  if (band.rms == 0.0) return std::nullopt;
  return BandNoise(seed, stream, band);
}

}  // namespace

Neuromuscular::Neuromuscular(const NeuromuscularConfig& config, std::uint64_t seed)
    : config_(config),
      vibration_m_s2_(kFelt_s),
      motor_n_(kFelt_s),
      wander_noise_(seed, kWanderStream),
      involuntary_(noise(seed, kInvoluntaryStream, {0.1, 5.0, config.involuntary_force_n})),
      tremor_(noise(seed, kTremorStream, {7.0, 12.0, config.tremor_force_n})),
      unmeasured_(noise(seed, kUnmeasuredStream,
                        {kUnmeasuredLow_hz, kUnmeasuredHigh_hz, config.unmeasured_force_n_s2_m})),
      resistance_delay_(static_cast<std::size_t>(ticks_in(config.motor_resistance_delay_s))),
      wander_(config.wander * wander_noise_()),
      until_change_(ticks_in(config.change_at_s)) {}

void Neuromuscular::update(bool pegged) noexcept {
  const double steps =
      static_cast<double>(kUpdate_ticks) * kControlPeriod_s / config_.wander_time_s;
  const double keep = std::exp(-steps);
  wander_ = keep * wander_ + config_.wander * std::sqrt(1.0 - keep * keep) * wander_noise_();
  double log_stiffness = wander_ + (until_change_ > 0 ? 0.0 : std::log1p(config_.change));
  if (!pegged) {
    const double growth = config_.stiffening_by_vibration_s2_m * vibration_m_s2_.value() +
                          config_.stiffening_by_motor_n * motor_n_.value();
    log_stiffness += std::log1p(std::max(growth, kMostSoftening));
  }
  level_ = std::clamp(static_cast<int>(std::lround(log_stiffness / StiffnessLevels::kStep)),
                      StiffnessLevels::kLowest, StiffnessLevels::kHighest);
}

Neuromuscular::Output Neuromuscular::step(const Input& input) noexcept {
  vibration_m_s2_.step(input.acceleration_m_s2);
  motor_n_.step(input.motor_force_n);
  if (until_change_ > 0) --until_change_;
  if (--until_update_ < 0) {
    until_update_ = kUpdate_ticks - 1;
    update(input.pegged);
  }
  const double felt_n = resistance_delay_.step(input.motor_force_n);
  Output out;
  out.stiffness_level = level_;
  out.resisting_n = input.pegged ? 0.0 : -config_.motor_resistance * felt_n;
  if (involuntary_) out.hand_n += involuntary_->step();
  if (tremor_) out.hand_n += tremor_->step();
  if (unmeasured_) out.hand_n += vibration_m_s2_.value() * unmeasured_->step();
  return out;
}

Reflex::Reflex(const NeuromuscularConfig& config, double period_s)
    : acts_(config.reflex_stiffness_n_m > 0.0 || config.reflex_damping_n_s_m > 0.0),
      stiffness_n_m_(config.reflex_stiffness_n_m),
      damping_n_s_m_(config.reflex_damping_n_s_m),
      max_force_n_(config.reflex_max_force_n),
      delay_(static_cast<std::size_t>(std::lround(config.reflex_delay_s / period_s))),
      muscle_(kTwoPi * config.reflex_muscle_hz, config.reflex_muscle_damping, period_s) {}

double Reflex::step(double stretch_m, double stretch_m_s, bool idle) noexcept {
  const double wanted_n =
      delay_.step(idle ? 0.0 : stiffness_n_m_ * stretch_m + damping_n_s_m_ * stretch_m_s);
  return std::clamp(muscle_.step(wanted_n).x, -max_force_n_, max_force_n_);
}

}  // namespace stillhand::rig
