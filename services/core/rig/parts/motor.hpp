// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::rig {

/// DC motor, capstan and the drive's own barrier.
struct MotorConfig {
  double torque_constant_n_m_a = 0.0302;
  double capstan_ratio = 10.0;
  double current_limit_a = 10.0;
  double lag_s = 0.0015;
  double delay_s = 0.0;
  double gain = 1.0;
  std::int64_t max_motor_age_ticks = 10;
  double answer_wait_s = 0.0004;
  signal::ForceLimits limits;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("torque_constant_n_m_a", self.torque_constant_n_m_a, Range{0.001, 1.0},
          "[N m/A] k_T; maxon RE 40, 150 W, 24 V winding, data sheet");
    visit("capstan_ratio", self.capstan_ratio, Range{1.0, 50.0},
          "[-] radius of the stick drum divided by that of the motor pulley");
    visit("current_limit_a", self.current_limit_a, Range{0.1, 40.0},
          "[A] current limit of the amplifier; the RE 40 allows 6 A continuously and 10 A for "
          "seconds");
    visit("lag_s", self.lag_s, Range{0.0002, 0.02},
          "[s] current loop and capstan cable, first order; 1 to 2 ms");
    visit("delay_s", self.delay_s, Range{0.0, 0.2},
          "[s] from a command to its current: network, drive and their buffers; none by default");
    visit("gain", self.gain, Range{0.0, 2.0},
          "[-] force at the hand over the commanded one; 1: k_T and capstan as in the settings");
    visit("max_motor_age_ticks", self.max_motor_age_ticks, Range{1.0, 100.0},
          "[ticks] largest age of the sample that a motor command answers");
    visit("answer_wait_s", self.answer_wait_s, Range{0.0, 0.0007},
          "[s] longest wait after a raw sample for the motor command that answers it, to use it in "
          "the same tick; 0: no wait, a tick uses the command that was there at its beginning");
    visit.group("limits", self.limits);
  }

  /// The motor is driven after the sample of a tick, by the command that answers it; Eq. RG-38.
  [[nodiscard]] bool answers_in_tick() const noexcept { return answer_wait_s > 0.0; }
};

/// Motor command as the drive sees it.
struct MotorDemand {
  bool valid;      ///< false: none arrived yet
  Tick age_ticks;  ///< since the sample that it answers
  double force_n;  ///< at the hand, + right
  bool permitted;  ///< the interlock
};

/// Motor, METHOD Eq. RG-8: delay, gain, current limit, first-order lag, then the drive's last
/// barrier, which takes any force to exactly zero within `limits.ramp_ticks` of a command that is
/// missing, too old, not finite or not permitted.  Pure; never allocates or throws.
class Motor {
 public:
  struct Output {
    double force_n;  ///< at the hand, + right
    Flags
        flags;  ///< kInhibited, kInputStale, kInputInvalid, kSaturated, kSlewLimited, kRampingDown
  };

  /// @param lever_m  hand to pivot [m]
  /// @throws stillhand::ConfigError if a field is outside its range.
  Motor(const MotorConfig& config, double lever_m);

  Output step(const MotorDemand& demand) noexcept;
  /// True if the demand is valid, permitted, fresh and finite.
  [[nodiscard]] bool usable(const MotorDemand& demand) const noexcept;

 private:
  [[nodiscard]] bool fresh(const MotorDemand& demand) const noexcept {
    return demand.age_ticks >= 0 && demand.age_ticks <= max_age_ticks_;
  }

  signal::ForceEnvelope envelope_;
  std::int64_t max_age_ticks_;
  double current_limit_n_;  ///< force at the hand at the current limit
  double lag_blend_;
  double gain_;
  signal::DelayLine delay_;
  double lagged_n_ = 0.0;
};

}  // namespace stillhand::rig
