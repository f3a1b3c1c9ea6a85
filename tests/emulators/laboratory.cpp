// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/laboratory.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/bus/trial_codec.hpp"

namespace stillhand::emulators {
namespace {

// Amplifiers between the boards of the simulated sensors, +-10 V, and the drive's inputs, 0 to
// 3.3 V.  Settings of sensing that fit: devices_test.py.
constexpr double kSupply_v = 3.3;
constexpr double kMiddle_v = 1.65;
constexpr double kAccelGain = 0.97;
constexpr double kForceGain = 0.2;
// Of the sensors themselves: rig.yaml.
constexpr double kAccel_v_m_s2 = 0.1019716;
constexpr double kForce_v_n = 0.1;
constexpr double kTurn_rad_tick = 0.01;  // a quick hand

/// The drive has its own bounds: the simulated motor only keeps its lag.
rig::RigConfig without_barrier(rig::RigConfig config) {
  config.motor.limits = {.max_force_n = 60.0, .max_slew_n_s = 20000.0, .ramp_ticks = 1};
  return config;
}

}  // namespace

Person::Person(std::uint32_t domain, const std::filesystem::path& profiles) {
  runtime::Tap::Options options;
  options.name = "emulated_laboratory";
  options.domain = domain;
  options.profiles = profiles;
  options.wanted = [](const std::string& topic) {
    return topic == topics::kOperatorForce.name || topic == topics::kRawSample.name ||
           topic == topics::kTrialControl.name;
  };
  options.on_sample = [this](const auto& writer, const auto& sample) { take(writer, sample); };
  tap_ = std::make_unique<runtime::Tap>(std::move(options));
  tap_->start();
}

Person::~Person() { tap_->stop(); }

void Person::take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  if (writer.topic == topics::kOperatorForce.name) {
    stillhand_msgs::OperatorForce message;
    if (from_cdr(sample.bytes, message)) push_.store({true, message.tick(), message.force_n()});
  } else if (writer.topic == topics::kRawSample.name) {
    stillhand_msgs::RawSample message;
    if (from_cdr(sample.bytes, message)) tick_ = message.tick();
  } else {
    stillhand_msgs::TrialControl message;
    if (from_cdr(sample.bytes, message)) trial_.store(runtime::from_idl(message));
  }
}

void Person::put(rig::RigInput& input) {
  const Tick tick = tick_;
  const Push& push = push_.load();
  const Trial& trial = trial_.load();
  input.operator_valid = push.valid;
  input.operator_age_ticks = tick - push.tick;
  input.operator_force_n = push.force_n;
  input.pegged = trial.phase == TrialPhase::kPegged && trial.covers(tick);
}

Laboratory::Laboratory(const rig::RigConfig& config, MoteusEmulator& drive,
                       PlatformEmulator& platform)
    : lever_m_(config.stick.lever_m),
      rig_(without_barrier(config)),
      drive_(drive),
      platform_(platform) {}

void Laboratory::step(std::int64_t now_ns, Person* person) {
  rig::RigInput input;
  if (const auto wish = platform_.wish(now_ns)) {
    input.command_valid = true;
    input.command_position_m = wish->position_m;
    input.command_velocity_m_s = wish->velocity_m_s;
    input.command_acceleration_m_s2 = wish->acceleration_m_s2;
  }
  if (person != nullptr) person->put(input);
  input.motor_valid = true;
  input.motor_permitted = drive_.torque_n_m() != 0.0 || drive_.follows();
  input.motor_force_n = drive_.torque_n_m() / lever_m_;
  output_ = rig_.step(input);

  const rig::RigTruth& truth = output_.truth;
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  constexpr double kCounts = 4096.0;  // rig.yaml
  const double accel_v =
      (turned_ ? -1.0 : 1.0) * output_.raw.accel_y_v + kAccel_v_m_s2 * tilt_m_s2_;
  if (!held_) accel_v_ = saturated_ ? kSupply_v : kMiddle_v + kAccelGain * accel_v;
  const double force_v = output_.raw.load_cell_v + kForce_v_n * pull_n_;
  turn_rad_ += std::clamp(wanted_turn_rad_ - turn_rad_, -kTurn_rad_tick, kTurn_rad_tick);
  drive_.sense(
      {.position_rev = static_cast<double>(output_.raw.encoder_counts) / kCounts + slip_rev_ +
                       turn_rad_ / kTurn_rad,
       .velocity_rev_s = truth.omega_rad_s / kTurn_rad,
       .analog1 = (kMiddle_v + (swapped_ ? -kForceGain : kForceGain) * force_v) / kSupply_v,
       .analog2 = accel_v_ / kSupply_v});
  platform_.stand({.position_m = truth.platform_position_m,
                   .velocity_m_s = truth.platform_velocity_m_s,
                   .acceleration_m_s2 = seat_unknown_ ? std::numeric_limits<double>::quiet_NaN()
                                                      : truth.platform_acceleration_m_s2});
  drive_.tick(now_ns);
}

}  // namespace stillhand::emulators
