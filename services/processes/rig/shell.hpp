// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>

#include "idl/control_loop.h"
#include "services/bus/service.hpp"
#include "services/core/rig/plant.hpp"
#include "services/messages/rig/codec.hpp"
#include "services/processes/rig/interlock_report.hpp"
#include "services/system/process/interlock.hpp"
#include "services/system/process/latest_value.hpp"
#include "services/system/process/platform_permission.hpp"
#include "services/system/process/wake_up.hpp"

namespace stillhand::rig {

/// The process of the rig: one step each millisecond on an absolute schedule.  It holds the sample
/// clock that all other processes answer, so only this process has a timed loop.  The same for the
/// simulated rig and for one of devices.
class Shell {
 public:
  /// @param plant  outlives the shell
  /// @param motor  of the rig's settings: how long the motor command is waited for
  Shell(runtime::Service& service, Plant& plant, const MotorConfig& motor);
  void run();

 private:
  struct Announced {
    Trial trial;
    stillhand_msgs::SessionState session = stillhand_msgs::SESSION_WAITING;
  };
  /// Platform commands arrive before their tick; the shell keeps this many.
  static constexpr std::size_t kCommandsAhead = 64;

  /// False once the process may end: at a stop the motor goes to zero and the platform to rest.
  bool goes_on(Tick tick);
  /// Says at the first tick and at each trial which parts are devices.
  void note_parts(Tick tick);
  void tick_once(Tick tick, std::int64_t due_ns);
  /// Waits, with the limit of the settings, for the motor command that answers this tick.
  void await_answer(Tick tick, std::int64_t due_ns);
  /// What the platform may do in this tick.
  MotionLeave leave_for(const Announced& announced, Tick tick,
                        const stillhand_msgs::PlatformCommand* command);
  /// Nothing is wrong with the session, its processes and devices.
  [[nodiscard]] bool sound(const Trial& trial) const noexcept {
    return service_.bus().peers_alive() && plant_.unsound() == nullptr && !drive_ended(trial);
  }
  [[nodiscard]] const char* why_opened(const Trial& trial, Tick tick) noexcept;
  /// The motor's part of the input, as it is now: newest command and interlock.
  const stillhand_msgs::MotorCommand* take_motor(const Trial& trial, Tick tick, RigInput& input);
  /// A vehicle ended this trial's drive.
  [[nodiscard]] bool drive_ended(const Trial& trial) const noexcept {
    return trial.number >= 0 && trial.number == ended_trial_;
  }
  void report_interlock(const Trial& trial, Tick tick, double motor_force_n);
  const stillhand_msgs::PlatformCommand* command_for(Tick tick);
  const stillhand_msgs::MotorCommand* motor_now();

  runtime::Service& service_;
  Plant& plant_;
  MotorConfig motor_config_;
  runtime::Interlock interlock_;
  runtime::PlatformPermission permission_;
  InterlockReport interlock_report_;

  runtime::Publisher<stillhand_msgs::RawSample> raw_;
  runtime::Publisher<stillhand_msgs::RigTruth> truth_;

  // From the receiving thread.
  boost::lockfree::spsc_queue<stillhand_msgs::PlatformCommand, boost::lockfree::capacity<128>>
      arriving_commands_;
  runtime::LatestValue<stillhand_msgs::MotorCommand> motor_;
  runtime::WakeUp motor_came_;
  runtime::LatestValue<stillhand_msgs::OperatorForce> volition_;
  runtime::LatestValue<Announced> announced_;
  std::atomic<bool> motor_deadline_missed_{false};
  std::atomic<bool> emergency_stop_{false};  ///< requested; never reset

  // Of the loop.
  std::array<stillhand_msgs::PlatformCommand, kCommandsAhead> commands_;
  Tick motor_void_tick_ = -1;
  std::int64_t ended_trial_ = -1;  ///< of a platform command with kFault: a drive that was ended
  Tick stop_tick_ = -1;            ///< of the request to end; -1: none
  bool at_rest_ = true;            ///< no motor force, and the platform stands
  std::int64_t noted_trial_ = -1;  ///< newest trial at which the parts were noted
};

}  // namespace stillhand::rig
