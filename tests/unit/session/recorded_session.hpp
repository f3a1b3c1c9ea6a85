// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "apps/libraries/session/trial_outcome.hpp"
#include "idl/clock.h"
#include "idl/model.h"
#include "tests/support/session_file.hpp"

/// A short session's recording, every sample of which a test has written.
namespace stillhand::session::made {

inline constexpr Tick kTrial_ticks = 5000;  // the shortest trial that has a target: 5 s

/// Writes the bytes under a name of the running test's own.
inline std::string file_of(const std::vector<std::byte>& bytes) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = testing::TempDir() + "session_" + test->name() + ".mcap";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  return path;
}

/// Tracking trial of five seconds from a tick on.
inline TrialOutcome outcome_of(std::int64_t number, Condition label, Tick start_tick) {
  TrialOutcome outcome;
  outcome.planned = PlannedTrial{};
  outcome.planned.trial = {number, TrialPhase::kTracking, start_tick, kTrial_ticks, 100};
  outcome.planned.label = label;
  outcome.planned.moving = label != Condition::kA;
  outcome.planned.cancellation = label == Condition::kC;
  outcome.completed = true;
  return outcome;
}

/// Lateral acceleration [m/s^2]: 2 Hz, and so a whole number of cycles a trial.
inline double acceleration_m_s2(Tick tick) {
  return 2.0 * std::sin(2.0 * std::numbers::pi * 0.002 * static_cast<double>(tick));
}

/// A session's file with the messages that `evaluate` reads.
class Tape {
 public:
  void tracking(Tick tick, double target_m, double cursor_m) {
    stillhand_msgs::TrackingSample message;
    message.tick(tick);
    message.target_m(target_m);
    message.cursor_m(cursor_m);
    file.add(topics::kTrackingSample, message);
  }
  void truth(Tick tick, double feedthrough_n, double motor_n) {
    stillhand_msgs::RigTruth message;
    message.tick(tick);
    message.feedthrough_force_n(feedthrough_n);
    message.motor_force_n(motor_n);
    file.add(topics::kRigTruth, message);
  }
  /// The rig's sample of a tick, and the step that then used the command answering `motor_tick`.
  void used(Tick tick, std::int64_t raw_ns, Tick motor_tick, std::int64_t truth_ns) {
    stillhand_msgs::RawSample raw;
    raw.tick(tick);
    raw.stamp_ns(raw_ns);
    file.add(topics::kRawSample, raw);
    stillhand_msgs::RigTruth message;
    message.tick(tick);
    message.stamp_ns(truth_ns);
    message.motor_tick(motor_tick);
    message.feedthrough_force_n(1.0);
    file.add(topics::kRigTruth, message);
  }
  void sensed(Tick tick, double accel_y_m_s2) {
    stillhand_msgs::Sensed message;
    message.tick(tick);
    message.accel_y_m_s2(accel_y_m_s2);
    file.add(topics::kSensed, message);
  }
  void motor(Tick tick, std::int64_t acquired_ns, std::int64_t stamp_ns) {
    stillhand_msgs::MotorCommand message;
    message.tick(tick);
    message.acquired_ns(acquired_ns);
    message.stamp_ns(stamp_ns);
    file.add(topics::kMotorCommand, message);
  }
  void clock(const char* service, std::int64_t stamp_ns, std::int64_t offset_ns,
             double uncertainty_ns) {
    stillhand_msgs::ClockOffset message;
    message.service(service);
    message.stamp_ns(stamp_ns);
    message.offset_ns(offset_ns);
    message.uncertainty_ns(uncertainty_ns);
    file.add(topics::kClockOffset, message);
  }
  /// A target that swings by 30 mm, and a cursor that is off by the same everywhere.
  void whole_tracking(Tick first, Tick end, double off_m) {
    for (Tick tick = first; tick < end; ++tick) {
      const double target_m =
          0.03 * std::sin(2.0 * std::numbers::pi * 0.0004 * static_cast<double>(tick));
      tracking(tick, target_m, target_m - off_m);
    }
  }
  [[nodiscard]] std::string close() { return file_of(file.close()); }

  tests::SessionFile file;
};

}  // namespace stillhand::session::made
