// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/rig/parts/band_noise.hpp"
#include "services/core/rig/parts/neuromuscular_config.hpp"
#include "services/core/rig/parts/sensor_noise.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/core/signal/running_rms.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::rig {

/// Stiffness of shoulder and grip over that of the body's settings, in even steps of its logarithm.
struct StiffnessLevels {
  static constexpr double kStep = 0.02;
  static constexpr int kLowest = -40;  ///< exp(-0.8) = 0.45
  static constexpr int kHighest = 80;  ///< exp(1.6) = 5
};

/// Forces and stiffness that nerves and muscles add, but for the reflex, which needs the chain.
/// Source: METHOD Eq. RG-27, 28, 30, 31, 32 and 40.
/// Pure: no clock, no I/O; the same seed gives the same bits; step() never allocates or throws.
class Neuromuscular {
 public:
  struct Input {
    double acceleration_m_s2;  ///< a_y of the platform
    double motor_force_n;      ///< at the hand, + right
    bool pegged;               ///< the hand is idle
  };
  struct Output {
    int stiffness_level = 0;   ///< of StiffnessLevels
    double hand_n = 0.0;       ///< involuntary and unmeasured force on the hand, + right
    double resisting_n = 0.0;  ///< force of the hand against the motor, + right
  };

  /// @param seed  of the rig
  Neuromuscular(const NeuromuscularConfig& config, std::uint64_t seed);

  Output step(const Input& input) noexcept;

 private:
  static constexpr std::int64_t kUpdate_ticks = 100;

  void update(bool pegged) noexcept;

  NeuromuscularConfig config_;
  signal::RunningRms vibration_m_s2_;
  signal::RunningRms motor_n_;
  SensorNoise wander_noise_;
  std::optional<BandNoise> involuntary_;
  std::optional<BandNoise> tremor_;
  std::optional<BandNoise> unmeasured_;
  signal::DelayLine resistance_delay_;
  double wander_;  ///< logarithm
  int level_ = 0;
  std::int64_t until_update_ = 0;
  std::int64_t until_change_;
};

/// Stretch reflex of the shoulder, Eq. RG-29, for one chain: muscle(k d + c d') of the delayed
/// stretch d = x_a - x_t, bounded.  Pure; never allocates or throws after construction.
class Reflex {
 public:
  Reflex(const NeuromuscularConfig& config, double period_s);

  [[nodiscard]] bool acts() const noexcept { return acts_; }
  /// One call a tick.  @return force that pulls the arm towards the trunk [N]
  double step(double stretch_m, double stretch_m_s, bool idle) noexcept;

 private:
  bool acts_;
  double stiffness_n_m_;
  double damping_n_s_m_;
  double max_force_n_;
  signal::DelayLine delay_;
  signal::SecondOrderLag muscle_;
};

}  // namespace stillhand::rig
