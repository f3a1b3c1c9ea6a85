// SPDX-License-Identifier: Apache-2.0
#include "services/processes/rig/shell.hpp"

#include <algorithm>
#include <cmath>

#include "idl/session_state.hpp"

namespace stillhand::rig {
namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;
// If the loop is later than this, its schedule restarts from now. Catching up would make a burst of
// ticks, in which the newest motor command would appear too old.
constexpr std::int64_t kMaxCatchUp_ns = 5 * kPeriod_ns;
// From the request to end to zero force and a platform that stands: the platform's highest speed at
// its deceleration takes 300 ticks with the default settings.
constexpr Tick kMostEnd_ticks = 1000;
constexpr double kRest_m_s = 0.001;

}  // namespace

Shell::Shell(runtime::Service& service, Plant& plant, const MotorConfig& motor)
    : service_(service),
      plant_(plant),
      motor_config_(motor),
      raw_(service.bus().publisher<stillhand_msgs::RawSample>(topics::kRawSample)),
      truth_(service.bus().publisher<stillhand_msgs::RigTruth>(topics::kRigTruth)) {
  for (auto& command : commands_) command.tick(-1);
  // Tick -1 means "none" until the first message arrives.
  stillhand_msgs::MotorCommand no_motor;
  no_motor.tick(-1);
  for (int i = 0; i < 3; ++i) motor_.store(no_motor);
  stillhand_msgs::OperatorForce no_force;
  no_force.tick(-1);
  for (int i = 0; i < 3; ++i) volition_.store(no_force);

  runtime::Bus& bus = service.bus();
  bus.subscribe<stillhand_msgs::PlatformCommand>(
      topics::kPlatformCommand,
      [this](const auto& message, const auto&) { arriving_commands_.push(message); });
  bus.subscribe<stillhand_msgs::MotorCommand>(topics::kMotorCommand,
                                              [this](const auto& message, const auto&) {
                                                motor_.store(message);
                                                if (motor_config_.answers_in_tick())
                                                  motor_came_.post();
                                              });
  bus.subscribe<stillhand_msgs::OperatorForce>(
      topics::kOperatorForce,
      [this](const auto& message, const auto&) { volition_.store(message); });
  // This topic carries the life sign of every process; the rig does not use its content.
  bus.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                               [](const auto&, const auto&) {});
  // The emergency stop reaches the rig directly and works without the experiment.
  bus.subscribe<stillhand_msgs::SessionCommand>(
      topics::kSessionCommand, [this](const auto& message, const auto&) {
        if (message.action() == stillhand_msgs::SESSION_EMERGENCY_STOP) {
          emergency_stop_.store(true, std::memory_order_relaxed);
        }
      });
  service.on_trial([this](const Trial& trial, const stillhand_msgs::TrialControl& message) {
    announced_.store({trial, message.session()});
  });
  service.on_incident([this](const runtime::BusIncident& incident) {
    if (incident.kind == stillhand_msgs::EVENT_DEADLINE_MISSED &&
        incident.topic == &topics::kMotorCommand) {
      motor_deadline_missed_.store(true, std::memory_order_relaxed);
    }
  });
}

void Shell::run() {
  service_.run([this] {
    std::int64_t due_ns = runtime::monotonic_ns();
    Tick tick = 0;
    while (goes_on(tick)) {
      due_ns += kPeriod_ns;
      runtime::sleep_until_ns(due_ns);
      // A latched end of the previous session does not start the clock; the end of this session
      // does not stop it.
      if (tick == 0 && !is_running(announced_.load().session)) {
        plant_.wait();
        continue;
      }
      note_parts(tick);
      const std::int64_t late_ns = runtime::monotonic_ns() - due_ns;
      if (late_ns > kMaxCatchUp_ns) {
        due_ns += late_ns;
        service_.note_event(stillhand_msgs::EVENT_CYCLE_MISSED, "sample clock late",
                            static_cast<double>(late_ns) / 1000.0);
      }
      tick_once(tick++, due_ns);
    }
  });
}

// Once more at each trial: who joins later hears it, too.
void Shell::note_parts(Tick tick) {
  const std::int64_t trial = announced_.load().trial.number;
  if (tick != 0 && trial == noted_trial_) return;
  noted_trial_ = trial;
  if (const char* parts = plant_.parts()) service_.note_event(stillhand_msgs::EVENT_NOTE, parts);
}

bool Shell::goes_on(Tick tick) {
  if (!service_.stop().requested()) return true;
  if (stop_tick_ < 0) stop_tick_ = tick;
  return !at_rest_ && tick - stop_tick_ < kMostEnd_ticks;
}

void Shell::tick_once(Tick tick, std::int64_t due_ns) {
  const Announced& announced = announced_.load();
  const Trial trial = announced.trial;
  if (emergency_stop_.load(std::memory_order_relaxed)) interlock_.stop();
  plant_.begin(trial, tick);
  const auto* command = command_for(tick);
  const MotionLeave leave = leave_for(announced, tick, command);
  // Without leave the platform brakes and holds.  Until the trial begins it comes to a command at
  // rest alone: a motion that still goes on is not its own.
  const bool early = leave == MotionLeave::kEngage && command != nullptr &&
                     !(std::abs(command->velocity_m_s()) < kRest_m_s);
  if (leave == MotionLeave::kHold || early) command = nullptr;
  const auto& newest_force = volition_.load();
  const auto* volition = newest_force.tick() >= 0 ? &newest_force : nullptr;
  const bool pegged = trial.phase == TrialPhase::kPegged && trial.covers(tick);
  RigInput input = make_input(tick, command, nullptr, volition, pegged, false);
  input.leave = leave;

  // The sample goes out before the motor is driven, so that its answer can drive it.
  const bool waits = motor_config_.answers_in_tick();
  const auto* motor = waits ? nullptr : take_motor(trial, tick, input);
  RigOutput output = waits ? plant_.sample(input) : plant_.step(input);
  auto raw = to_idl(output, tick);
  raw_.write(raw);
  if (waits) {
    await_answer(tick, due_ns);
    motor = take_motor(trial, tick, input);
    plant_.drive(input, output);
  }
  // Before anything else loads a message: that may give the place of this one away.
  UsedTicks used;
  if (command != nullptr) used.command = command->tick();
  if (leave == MotionLeave::kHold) used.command = UsedTicks::kHeld;
  if (motor != nullptr) used.motor = motor->tick();
  if (volition != nullptr) used.volition = volition->tick();
  at_rest_ =
      output.truth.motor_force_n == 0.0 && std::abs(output.truth.platform_velocity_m_s) < kRest_m_s;
  report_interlock(trial, tick, output.truth.motor_force_n);

  auto truth = to_idl(output, tick, input, used);
  truth_.write(truth);
  if (const char* notice = plant_.notice()) {
    service_.note_event(stillhand_msgs::EVENT_NOTE, notice);
  }
  if (plant_.prepared()) service_.note_armed(trial.number);
  service_.note_tick(tick);
}

void Shell::await_answer(Tick tick, std::int64_t due_ns) {
  // A tick that is late itself waits less: the next one begins in time.
  constexpr std::int64_t kReserve_ns = 200'000;
  const auto wait_ns = static_cast<std::int64_t>(motor_config_.answer_wait_s * 1e9);
  const std::int64_t until_ns =
      std::min(runtime::monotonic_ns() + wait_ns, due_ns + kPeriod_ns - kReserve_ns);
  motor_came_.wait_until_ns(until_ns, [&] { return motor_.load().tick() >= tick; });
}

const stillhand_msgs::MotorCommand* Shell::take_motor(const Trial& trial, Tick tick,
                                                      RigInput& input) {
  // A stop that came during the wait counts.
  if (emergency_stop_.load(std::memory_order_relaxed)) interlock_.stop();
  const bool closed = interlock_.step(trial, tick, sound(trial) && !permission_.latched(trial));
  const bool permitted = closed && stop_tick_ < 0;
  const auto* motor = motor_now();
  put_motor(input, tick, motor, permitted);
  return motor;
}

const char* Shell::why_opened(const Trial& trial, Tick tick) noexcept {
  if (interlock_.stopped()) return "emergency stop";
  if (const char* unsound = plant_.unsound()) return unsound;
  if (drive_ended(trial)) return "growing oscillation of the stick";
  if (permission_.motion_lost(trial)) {
    // Both answer the samples of sensing, whose own life sign is given longer.
    const bool both = motor_.load().tick() < tick - runtime::PlatformPermission::kMostMissing_ticks;
    return both ? "motion and cancellation are silent: does sensing stand?"
                : "no commands of motion";
  }
  return service_.bus().why_not_alive();
}

MotionLeave Shell::leave_for(const Announced& announced, Tick tick,
                             const stillhand_msgs::PlatformCommand* command) {
  // One that is no number counts as missing, as in the platform.
  const bool usable = command != nullptr && std::isfinite(command->position_m()) &&
                      std::isfinite(command->velocity_m_s()) &&
                      std::isfinite(command->acceleration_m_s2());
  if (interlock_.stopped()) permission_.stop();
  const bool runs = announced.session == stillhand_msgs::SESSION_RUNNING && stop_tick_ < 0;
  return permission_.step(announced.trial, tick,
                          {.runs = runs, .sound = sound(announced.trial), .command = usable});
}

void Shell::report_interlock(const Trial& trial, Tick tick, double motor_force_n) {
  // What latches the platform before the trial begins is reported then, too.
  const auto notice =
      interlock_report_.step(interlock_.latched(trial) || permission_.latched(trial),
                             interlock_.stopped(), tick, motor_force_n);
  if (notice.opened) {
    service_.note_event(
        stillhand_msgs::EVENT_INTERLOCK_OPENED, why_opened(trial, tick), 0.0,
        interlock_.stopped() ? stillhand_msgs::CODE_EMERGENCY_STOP : stillhand_msgs::CODE_NONE);
  }
  if (notice.force_zero) {
    service_.note_event(stillhand_msgs::EVENT_FORCE_ZERO, "",
                        static_cast<double>(notice.after_ticks) * kControlPeriod_s * 1e6);
  }
}

const stillhand_msgs::PlatformCommand* Shell::command_for(Tick tick) {
  arriving_commands_.consume_all([this](const stillhand_msgs::PlatformCommand& command) {
    if ((command.flags() & kFault) != 0) ended_trial_ = command.trial();
    if (command.tick() >= 0) {
      commands_[static_cast<std::size_t>(command.tick()) % kCommandsAhead] = command;
    }
  });
  const auto& slot = commands_[static_cast<std::size_t>(tick) % kCommandsAhead];
  return slot.tick() == tick ? &slot : nullptr;
}

const stillhand_msgs::MotorCommand* Shell::motor_now() {
  const auto& newest = motor_.load();
  // A missed DDS deadline voids the newest command; the next command is valid again.
  if (motor_deadline_missed_.exchange(false, std::memory_order_relaxed)) {
    motor_void_tick_ = newest.tick();
  }
  return newest.tick() > motor_void_tick_ ? &newest : nullptr;
}

}  // namespace stillhand::rig
