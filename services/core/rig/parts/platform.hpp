// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/slow_way.hpp"

namespace stillhand::rig {

/// Motion platform: the position loop of its drive, and its own hard limits.
struct PlatformConfig {
  double workspace_m = 0.15;
  double max_velocity_m_s = 1.5;
  double max_acceleration_m_s2 = 15.0;
  double loop_frequency_hz = 12.0;
  double loop_damping = 0.8;
  double acceleration_feedforward = 0.8;
  double torque_lag_s = 0.002;
  double catch_velocity_m_s = 0.25;
  double stop_deceleration_m_s2 = 5.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("workspace_m", self.workspace_m, Range{0.01, 5.0},
          "[m] travel, each side of the centre; paper III-C (0.15 m)");
    visit("max_velocity_m_s", self.max_velocity_m_s, Range{0.1, 10.0},
          "[m/s] speed limit of the ball screw; 0.15 m at 0.7 Hz needs 0.66 m/s");
    visit("max_acceleration_m_s2", self.max_acceleration_m_s2, Range{1.0, 50.0},
          "[m/s^2] acceleration limit of the servo motor; twice the 7.5 m/s^2 of paper III-C");
    visit(
        "loop_frequency_hz", self.loop_frequency_hz, Range{1.0, 30.0},
        "[Hz] natural frequency of the position loop; paper III-C requires a bandwidth above 6 Hz");
    visit("loop_damping", self.loop_damping, Range{0.3, 2.0}, "[-] damping ratio of that loop");
    visit("acceleration_feedforward", self.acceleration_feedforward, Range{0.0, 1.0},
          "[-] share of the commanded acceleration fed forward");
    visit("torque_lag_s", self.torque_lag_s, Range{0.0005, 0.01},
          "[s] first-order lag of the drive's torque loop and the screw");
    visit("catch_velocity_m_s", self.catch_velocity_m_s, Range{0.01, 2.0},
          "[m/s] largest speed at which the platform approaches a distant command");
    visit("stop_deceleration_m_s2", self.stop_deceleration_m_s2, Range{0.5, 50.0},
          "[m/s^2] deceleration when the command is missing");
  }
};

/// Motion of the platform in the room, + to the subject's right.
struct PlatformState {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
};

/// Command for this tick; `valid` false: no command arrived.
struct PlatformDemand {
  bool valid;
  double position_m;
  double velocity_m_s;
  double acceleration_m_s2;
  bool held = false;  ///< no permission to move: the command does not count
};

/// Ideal motion source for the body:
///
///   v_d = v_c + clip((w/2z)(x_c - x), V_catch),  a_d = 2 z w (v_d - v) + k_a a_c
///   tau da/dt = a_d - a
///
/// Eq. RG-2 then limits the acceleration so that the platform can still stop inside its workspace.
/// Without a command it brakes to rest and holds; so it does while it is held, and comes from there
/// to the next command on the slow way of Eq. SG-21.  Acceleration is constant within a tick;
/// position_m and velocity_m_s are the values at its end.
/// Source: METHOD Eq. RG-1 and RG-2; paper II-A (the vehicle is much heavier than the body).
/// Pure; never allocates or throws.
class Platform {
 public:
  struct Output {
    PlatformState state;
    Flags flags;  ///< kInhibited (held), kInputStale (no command), kInputInvalid, kSaturated,
                  ///< kWorkspaceLimit
  };

  /// @throws stillhand::ConfigError if a field is outside its range or the loop is unstable.
  explicit Platform(const PlatformConfig& config);

  /// One tick.
  Output step(const PlatformDemand& demand) noexcept;

 private:
  /// Puts the slow way from where it was held into a command.
  [[nodiscard]] PlatformDemand from_hold(const PlatformDemand& demand) noexcept;
  [[nodiscard]] double wanted_acceleration(const PlatformDemand& demand,
                                           Flags& flags) const noexcept;
  /// Largest acceleration that still allows a stop before a wall at `room_m`, Eq. RG-2.
  [[nodiscard]] double brakeable(double room_m, double closing_m_s) const noexcept;

  PlatformConfig config_;
  double rate_gain_s_;      ///< 2 z w [1/s]
  double position_gain_s_;  ///< w / 2z [1/s]
  double brake_s2_m_;       ///< 1 / (2 max_acceleration)
  double lag_blend_;        ///< 1 - exp(-dt / tau) [-]
  PlatformState state_;
  bool held_ = false;
  signal::SlowWay way_;  ///< from where it was held
};

}  // namespace stillhand::rig
