// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/contract/flag.hpp"
#include "services/core/contract/motion_leave.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/device_rig/platform_protocol.hpp"
#include "services/core/motion/platform_guard.hpp"
#include "services/core/signal/slow_way.hpp"

namespace stillhand::device_rig {

/// Life of a platform as the rig sees it.
enum class SeatStage : std::uint8_t {
  kAbsent,     ///< no reply that is young enough
  kStanding,   ///< it replies, and holds
  kEngaging,   ///< it comes slowly from where it stands to where the trial begins
  kFollowing,  ///< it follows the commands
  kBraking,    ///< the permission ended: the set-point comes to rest
  kFaulted     ///< it lost its permission for this trial
};

/// Why a platform is faulted; text_of() says it.
enum class SeatReason : std::uint8_t {
  kNone,
  kSilent,    ///< no young reply: it may have braked by itself
  kFault,     ///< it reports a fault
  kOff,       ///< it stopped following by itself
  kStranger,  ///< it follows somebody else
  kLate,      ///< it was not engaged when the trial began
  kOutside    ///< it stands outside of its travel
};
const char* text_of(SeatReason reason) noexcept;

/// Decides what a platform is asked for, METHOD Eq. DR-20 to DR-24.  Nothing moves without the
/// permission of this trial; a set-point begins where the platform reports to stand; each one can
/// be stopped before the wall (Eq. MO-1, the guard of motion); a platform that lost its permission
/// in a trial moves again in another one alone.  Without permission the set-point brakes by Eq.
/// MO-4 and MO-16 and the platform holds.
/// Pure: time is a tick; never allocates or throws; one thread.
class PlatformDrive {
 public:
  struct Limits {
    motion::PlatformLimits guard;
    double most_jerk_m_s3 = 1000.0;
    Tick most_age_ticks = 50;            ///< of a reply, while it holds
    Tick most_following_age_ticks = 20;  ///< of a reply, while it is asked to follow
  };
  struct Input {
    MotionLeave leave = MotionLeave::kHold;
    bool measured = false;  ///< the tick is in the measured part of the trial
    std::int64_t trial = -1;
    Tick age_ticks = kNever;  ///< of the newest reply
    PlatformReply reply;
    bool stranger = false;  ///< the platform follows somebody else
    motion::GuardInput wanted;
  };
  struct Output {
    SeatStage stage = SeatStage::kAbsent;
    SetPoint set_point;
    Flags flags = kGood;  ///< kInhibited (it holds), those of motion::PlatformGuard
    bool began = false;   ///< the slow way begins in this tick
  };
  static constexpr Tick kNever = Tick{1} << 60;

  /// @throws ConfigError for limits out of the guard's ranges
  explicit PlatformDrive(const Limits& limits)
      : limits_(limits), guard_(limits.guard, limits.most_jerk_m_s3) {}

  Output step(const Input& input) noexcept;
  [[nodiscard]] SeatStage stage() const noexcept { return stage_; }
  /// It follows set-points, as it says itself, and is where the trial begins.
  [[nodiscard]] bool engaged() const noexcept { return stage_ == SeatStage::kFollowing; }
  [[nodiscard]] SeatReason reason() const noexcept { return reason_; }
  /// Trial in which it was faulted last.
  [[nodiscard]] std::int64_t trial() const noexcept { return blocked_trial_; }
  /// Fault bits of the platform when it was faulted.
  [[nodiscard]] std::uint32_t fault() const noexcept { return fault_; }
  [[nodiscard]] const signal::SlowWay& way() const noexcept { return way_; }

 private:
  [[nodiscard]] bool asks_to_follow() const noexcept;
  [[nodiscard]] double within_travel(double position_m) const noexcept;
  [[nodiscard]] SeatReason trouble(const Input& input) const noexcept;
  void look_whether_it_stands(const Input& input) noexcept;
  Output idle(const Input& input) noexcept;
  Output hold(const Input& input) noexcept;
  Output driven(const Input& input) noexcept;
  Output await_confirmation(const Input& input) noexcept;
  Output braking(const Input& input) noexcept;
  Output faulted(const Input& input) noexcept;
  Output fail(const Input& input, SeatReason reason) noexcept;
  Output ask(const motion::GuardInput& wanted) noexcept;

  Limits limits_;
  motion::PlatformGuard guard_;
  signal::SlowWay way_;
  SeatStage stage_ = SeatStage::kAbsent;
  SeatReason reason_ = SeatReason::kNone;
  std::uint32_t fault_ = 0;
  std::int64_t blocked_trial_ = -2;
  bool fresh_ = false;
  bool confirmed_ = false;         ///< the platform has said that it follows
  double stood_m_ = 0.0;           ///< it is within a millimetre of this place
  Tick stands_ticks_ = 0;          ///< for so long
  bool held_ = false;              ///< hold_m_ is known
  bool moved_in_silence_ = false;  ///< it is back in this tick, and not where it was
  double hold_m_ = 0.0;            ///< set-point of a platform that stays engaged
};

}  // namespace stillhand::device_rig
