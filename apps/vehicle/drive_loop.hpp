// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "apps/libraries/session/loop.hpp"
#include "services/core/admittance/interleaved_multisines.hpp"
#include "services/core/admittance/line_responses.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/record.hpp"
#include "services/core/vehicle/driven_motion.hpp"

namespace stillhand::vehicle {

/// Settings of the cores of a drive.
struct DriveConfigs {
  rig::RigConfig rig;
  sensing::Config sensing;
  cancellation::Config cancellation;
  DrivenConfig driven;
};

/// A free stick while motor and platform follow the two multisines, over whole periods.
struct FreeStick {
  admittance::FreeStickRecord record;  ///< with the sensed stick angle [rad] in displacement_m
  std::vector<double> sensed_acceleration_m_s2;
};

/// What came of one drive.
struct DriveOutcome {
  double minutes = 0.0;               ///< driven
  bool ended = false;                 ///< by the detector
  double ended_s = 0.0;               ///< after the first measured tick
  double frequency_hz = 0.0;          ///< of the oscillation found
  double periods_from_floor = 0.0;    ///< since every half wave passes the floor, to the end
  double periods_from_ceiling = 0.0;  ///< the same of its ceiling; 0 where it was not passed
  double largest_rad = 0.0;           ///< |theta| over the drive
  double rms_rad = 0.0;               ///< theta over the last 5 s of a drive that was not ended
  double rest_s = 0.0;                ///< from the end by the detector to a platform at rest
  double motor_zero_s = 0.0;  ///< from the end by the detector to a motor force of exactly 0
  double farthest_m = 0.0;    ///< |x| of the platform's set-point
  double fastest_m_s = 0.0;   ///< |v| of the same
  double hardest_m_s2 = 0.0;  ///< |a| of the same
  bool shaped = false;        ///< the guard or a bound shaped a command
};

/// Drives of a vehicle around the session's Loop: a platform command answers the stick of 20 ticks
/// before.  The subject holds the stick and steers nowhere.  Deterministic.  One thread.
class DriveLoop {
 public:
  /// @param seed  of sensors and of the subject's own forces
  /// @throws ConfigError as the cores do.
  DriveLoop(DriveConfigs configs, std::uint64_t seed);

  /// The paper's pegged trial (III-A): noise of 0.7 to 4 Hz.  @return acceleration and force, 1 kHz
  identification::Record pegged(double seconds, std::uint64_t seed);
  /// The free stick, motor and platform at interleaved lines (services/core/admittance); one period
  /// settles before those that are kept.
  FreeStick free_stick(const admittance::Excitation& excitation, int periods);
  /// The model of condition C.  @throws ConfigError when the canceller refuses it.
  void use_model(const identification::FeedthroughModel& model);
  /// One drive: ramps of one second, then `seconds`.
  DriveOutcome run(double seconds, bool cancel);

 private:
  /// @param perturbation_n  [N] on top of the countermeasure's force
  session::Turned tick_once(const session::Turn& turn, bool cancel = false,
                            double perturbation_n = 0.0);
  /// A trial that begins as soon as the lead allows.
  Trial next_trial(double seconds);
  /// Platform and motor to rest.
  void settle(double seconds);

  session::Loop loop_;
  cancellation::Countermeasure countermeasure_;
  DrivenMotion driven_;
  std::array<motion::PlatformCommand, kLead_ticks> ahead_{};
  motion::PlatformCommand last_command_;
  double floor_rad_;
  double ceiling_rad_;
  Tick tick_ = 0;
  std::int64_t trials_ = 0;
};

}  // namespace stillhand::vehicle
