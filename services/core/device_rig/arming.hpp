// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/device_rig/drive_protocol.hpp"

namespace stillhand::device_rig {

/// Life of the drive as the rig sees it.
enum class Stage : std::uint8_t {
  kAbsent,   ///< no reply that is young enough
  kFound,    ///< it replies; its settings are not read back
  kChecked,  ///< its settings are right; the driver is off
  kArmed,    ///< it follows torque commands
  kFaulted   ///< it lost its permission for this trial
};

/// Why a drive is faulted; text_of() says it.
enum class Reason : std::uint8_t {
  kNone,
  kSilent,     ///< no young reply
  kTimedOut,   ///< its watchdog tripped
  kFault,      ///< it reports a fault
  kOff,        ///< the driver went off by itself: a new start, or somebody stopped it
  kOtherMode,  ///< somebody else commands it
  kNotArmed,   ///< it did not follow the command to arm
  kUnchecked,  ///< it was away or started again, and its settings are not read back
  kEncoder     ///< the angle jumped by more than a hand can move
};
const char* text_of(Reason reason) noexcept;

/// Decides when the drive follows torque commands, METHOD Eq. DR-4 to DR-8.  Nothing arms by
/// itself; a drive that lost its permission in a trial is armed again in another trial alone; an
/// armed drive begins at zero torque.  Pure; one thread; never allocates.
class Arming {
 public:
  struct Input {
    bool fresh = false;                ///< the newest reply is young enough
    bool checked = false;              ///< the drive's settings are read back and right
    bool jumped = false;               ///< the angle jumped
    DriveMode mode = DriveMode::kOff;  ///< of the newest reply
    int fault = 0;                     ///< same
    bool wanted = false;     ///< a trial with a free stick, interlock closed, power stage on
    bool force_zero = true;  ///< the force after all limits is exactly 0
    std::int64_t trial = -1;
  };
  struct Output {
    Stage stage = Stage::kAbsent;
    Order order = Order::kQuery;
    Reason reason = Reason::kNone;  ///< of kFaulted
    bool follows = false;  ///< armed, and the drive has said so: before that the torque is 0
  };

  Output step(const Input& input) noexcept;
  [[nodiscard]] Stage stage() const noexcept { return stage_; }
  [[nodiscard]] Reason reason() const noexcept { return reason_; }
  /// Trial in which it was faulted last.
  [[nodiscard]] std::int64_t trial() const noexcept { return blocked_trial_; }
  /// Fault code of the drive when it was faulted; 0: none.
  [[nodiscard]] int fault() const noexcept { return fault_; }

 private:
  /// Until the drive says that it follows, and that it is off [ticks].
  static constexpr std::int64_t kPatience_ticks = 50;

  Output idle(const Input& input) noexcept;
  Output armed(const Input& input) noexcept;
  Output faulted(const Input& input) noexcept;
  Output fail(const Input& input, Reason reason) noexcept;
  [[nodiscard]] Reason trouble(const Input& input) const noexcept;

  Stage stage_ = Stage::kAbsent;
  Reason reason_ = Reason::kNone;
  int fault_ = 0;
  std::int64_t blocked_trial_ = -2;
  std::int64_t since_ticks_ = 0;  ///< in mode-changing states
  bool confirmed_ = false;        ///< the drive has said that it follows
};

}  // namespace stillhand::device_rig
