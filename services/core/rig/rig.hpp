// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/flag.hpp"
#include "services/core/contract/motion_leave.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/rig/parts/body.hpp"
#include "services/core/rig/parts/motor.hpp"
#include "services/core/rig/parts/platform.hpp"
#include "services/core/rig/parts/rig_config.hpp"
#include "services/core/rig/parts/sensors.hpp"
#include "services/core/rig/undeclared/sealed_effect.hpp"
#include "services/core/signal/force_envelope.hpp"

namespace stillhand::rig {

/// All inputs of the rig in one tick.
struct RigInput {
  /// Of the platform; in one process, where nobody sits, every command is followed.
  MotionLeave leave = MotionLeave::kFollow;
  bool command_valid = false;  ///< a platform command for this tick arrived
  double command_position_m = 0.0;
  double command_velocity_m_s = 0.0;
  double command_acceleration_m_s2 = 0.0;
  bool motor_valid = false;       ///< a motor command has arrived
  Tick motor_age_ticks = 0;       ///< since the sample that it answers
  double motor_force_n = 0.0;     ///< at the hand, + right
  bool operator_valid = false;    ///< a volitional force has arrived
  Tick operator_age_ticks = 0;    ///< since the sample that it answers
  double operator_force_n = 0.0;  ///< at the hand, + right
  bool pegged = false;            ///< the peg holds the stick at theta = 0
  bool motor_permitted = false;   ///< interlock: every required process alive, and a trial runs
};

/// Quantities that only a simulated rig knows; recorded for evaluation, never used for control.
struct RigTruth {
  double platform_position_m, platform_velocity_m_s, platform_acceleration_m_s2;
  double theta_rad, omega_rad_s;
  double feedthrough_force_n;  ///< f'_b: force of the body on a stick held at 0
  double motor_force_n;        ///< after limits and lag; when it acts: drive(), step()
  double volitional_force_n;   ///< applied, after its bound
  double hand_force_n;         ///< through the load cell, without noise
};

struct RigOutput {
  RawSample raw;
  RigTruth truth;
  Flags flags;        ///< of all parts but the motor, combined with bitwise OR
  Flags motor_flags;  ///< of the motor's newest drive(): of the force that `truth` states
  [[nodiscard]] Flags all_flags() const noexcept { return flags | motor_flags; }
};

/// Simulated platform, subject, stick, motor and sensors; it replaces the hardware.
///
///   command -> Platform -> a_y -> Body (+ Motor, volitional force) -> Sensors -> RawSample
/// A volitional force that is stale or not finite fades to zero within 50 ticks.  Without one
/// (operator_valid false) the force is 0.
/// Source: METHOD Eq. RG-1 to RG-11, RG-38; paper section III-C.
/// Pure: the same config and inputs give the same bits; step() never allocates, locks or throws.
/// The output is finite and bounded for every input.
class Rig {
 public:
  /// @throws stillhand::ConfigError naming the first field that is out of range.
  /// @param sealed  the undeclared effect; none by default
  explicit Rig(const RigConfig& config, SealedEffect sealed = {});
  ~Rig();
  Rig(Rig&&) noexcept;
  Rig& operator=(Rig&&) noexcept;

  /// One tick, the motor before the sample: drive(), then sample().  The recording of such a tick
  /// states the force that acted until its sample.
  RigOutput step(const RigInput& input) noexcept;

  /// The two halves of a tick, for a motor command that answers this tick's own sample, Eq. RG-38:
  /// first sample(), then drive().  Platform, body and sensors at this tick; the force of the last
  /// drive() acted since the sample before.  The motor's fields of the input are not used.
  RigOutput sample(const RigInput& input) noexcept;
  /// The motor's force from here to the next sample; `output`, of this tick's sample(), then states
  /// it.  Uses the motor's fields of the input alone.
  void drive(const RigInput& input, RigOutput& output) noexcept;

  /// Opens the sealed effect.  A later step or a second opening is a bug of the caller and aborts.
  [[nodiscard]] OpenedEffect open_effect();

 private:
  signal::ForceEnvelope::Output volitional(const RigInput& input) noexcept;
  Motor::Output motor(const RigInput& input) noexcept;
  [[nodiscard]] const ChainEffect& chain_effect() const noexcept;

  SealedEffect sealed_;
  bool opened_ = false;
  std::int64_t max_operator_age_ticks_;
  Platform platform_;
  Motor motor_;
  Motor::Output driven_{};  ///< of the last drive()
  signal::ForceEnvelope operator_envelope_;
  Neuromuscular neuromuscular_;
  Body body_;
  Sensors sensors_;
};

}  // namespace stillhand::rig
