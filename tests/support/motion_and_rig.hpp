// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>

#include "idl/control_loop.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::support {

inline runtime::Bus::Options bus_options(const std::string& service,
                                         const std::filesystem::path& security) {
  runtime::Bus::Options options;
  options.service = service;
  options.domain = own_domain();
  options.profiles = STILLHAND_SOURCE "/qos/profiles.xml";
  options.security = security;
  return options;
}

/// A lab's motion and rig: platform commands flow between them, and the rig is open for motor
/// commands, which nobody of this lab writes.
class MotionAndRig {
 public:
  explicit MotionAndRig(const std::filesystem::path& security)
      : motion(bus_options("motion", security)), rig(bus_options("rig", security)) {
    commands_ = motion.publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand);
    rig.subscribe<stillhand_msgs::PlatformCommand>(
        topics::kPlatformCommand, [this](const auto&, const auto&) { ++received; });
    rig.subscribe<stillhand_msgs::MotorCommand>(
        topics::kMotorCommand, [this](const stillhand_msgs::MotorCommand& message, const auto&) {
          if (motor_commands.load() == 0) first_motor_command = message;
          ++motor_commands;
        });
    motion.start();
    rig.start();
  }

  /// One platform command.
  void step() {
    ++command.tick();
    commands_.write(command);
  }
  /// Steps until the rig has `samples` more, doing `also` at each step.  @returns whether it came
  /// to that
  bool exchange(int samples, const std::function<void()>& also = [] {}) {
    const int goal = received.load() + samples;
    return eventually(
        [&] {
          step();
          also();
          return received.load() >= goal;
        },
        std::chrono::seconds(120));
  }

  std::atomic<int> received{0};        ///< platform commands at the rig
  std::atomic<int> motor_commands{0};  ///< at the rig, of whomever
  stillhand_msgs::MotorCommand first_motor_command;
  stillhand_msgs::PlatformCommand command;
  runtime::Bus motion, rig;

 private:
  runtime::Publisher<stillhand_msgs::PlatformCommand> commands_;
};

}  // namespace stillhand::support
