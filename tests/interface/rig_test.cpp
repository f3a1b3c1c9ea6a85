// SPDX-License-Identifier: Apache-2.0
// The rig's process on the real bus, with the test in place of all others: what the rig does by
// itself when a motor command stays away, at an emergency stop, and when it is asked to end.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/sources_codec.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/child.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand {
namespace {

using support::eventually;

constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";
constexpr Tick kLead = 20;  // of motion, services/processes/motion/shell.cpp
// 0.1 m at 0.5 Hz: 0.31 m/s at the middle of the travel.
constexpr double kTravel_m = 0.1;
constexpr double kOmega_rad_s = std::numbers::pi;
constexpr double kMoves_m_s = 0.2;
constexpr double kRest_m_s = 0.001;                 // services/processes/rig/shell.cpp
constexpr Tick kHeld = -2;                          // idl/README.md, command_tick
constexpr std::chrono::milliseconds kLifeSign{30};  // ten in the lease of 300 ms

/// A rig, and a test that drives it with one command for each sample.
class RigProcessTest : public testing::Test {
 protected:
  RigProcessTest() {
    sensing_.subscribe<stillhand_msgs::RawSample>(
        topics::kRawSample, [this](const auto& raw, const auto&) { answer(raw.tick()); });
    recorder_.subscribe<stillhand_msgs::RigTruth>(
        topics::kRigTruth, [this](const auto& truth, const auto&) { note(truth); });
    for (const auto& [service, bus] : own_) {
      life_.push_back(bus->publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus));
    }
    for (const auto& [service, bus] : own_) bus->start();
    name_sources();
    announce(-1);
    living_ = std::jthread([this](const std::stop_token& stop) { live(stop); });
  }
  ~RigProcessTest() override {
    living_ = {};
    rig_.finish();
    sensing_.stop_receiving();
    recorder_.stop_receiving();
  }

  /// Trial `number` covers every tick; -1: none is announced.
  void announce(std::int32_t number, Tick start_tick = 0) {
    stillhand_msgs::TrialControl control;
    control.session(stillhand_msgs::SESSION_RUNNING);
    control.trial(number);
    control.phase(number < 0 ? stillhand_msgs::PHASE_IDLE : stillhand_msgs::PHASE_TRACKING);
    control.start_tick(start_tick);
    control.duration_ticks(number < 0 ? 0 : 3'600'000);
    control_.write(control);
  }
  /// Every process shows its life sign but the lab's, once it died: in a thread of its own, as a
  /// test that waits shows none.
  void live(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any ended;
    std::unique_lock lock(mutex);
    do {
      std::size_t i = 0;
      for (const auto& [service, bus] : own_) {
        stillhand_msgs::ServiceStatus status;
        status.service(std::string(service));
        status.state(stillhand_msgs::SERVICE_RUNNING);
        if (service != "experiment" || !lab_is_dead_) life_[i].write(status);
        ++i;
      }
    } while (!ended.wait_for(lock, stop, kLifeSign, [] { return false; }) &&
             !stop.stop_requested());
  }

  /// The rig takes commands from the participants that its experiment names.
  void name_sources() {
    std::vector<runtime::Source> sources;
    for (const std::string_view service : topics::kServices) {
      sources.push_back({std::string(service), {}});
      const auto found = own_.find(service);
      if (found != own_.end()) sources.back().participant = found->second->participant();
    }
    auto message = runtime::to_idl(sources);
    sources_.write(message);
  }

  void answer(Tick tick) {
    stillhand_msgs::MotorCommand force;
    force.tick(tick);
    if (commands_force_) motor_.write(force);
    if (!commands_motion_) return;
    const double phase_rad = kOmega_rad_s * 1e-3 * static_cast<double>(tick + kLead);
    stillhand_msgs::PlatformCommand command;
    command.tick(tick + kLead);
    command.position_m(kTravel_m * std::sin(phase_rad));
    command.velocity_m_s(kTravel_m * kOmega_rad_s * std::cos(phase_rad));
    platform_.write(command);
  }
  void note(const stillhand_msgs::RigTruth& truth) {
    tick_ = truth.tick();
    motor_tick_ = truth.motor_tick();
    command_tick_ = truth.command_tick();
    speed_m_s_ = std::abs(truth.platform_velocity_m_s());
  }
  void expect_motion() {
    commands_motion_ = true;
    ASSERT_TRUE(eventually([this] { return command_tick_ == kHeld && tick_ > 500; }));
    EXPECT_LT(speed_m_s_, kRest_m_s) << "moves before a trial was announced";
    announce(1);
    ASSERT_TRUE(eventually([this] { return speed_m_s_ > kMoves_m_s; }));
  }
  /// From any speed in 300 ticks (services/processes/rig/shell.cpp), whatever motion commands.
  void expect_rest() {
    const Tick from = tick_;
    ASSERT_TRUE(eventually([this, from] { return tick_ > from + 400; }));
    EXPECT_LT(speed_m_s_, kRest_m_s);
  }

  std::atomic<bool> commands_force_{false}, commands_motion_{false};
  // The newest sample of the rig's truth.
  std::atomic<Tick> tick_{-1}, motor_tick_{-1}, command_tick_{-1};
  std::atomic<double> speed_m_s_{0.0};

  runtime::Bus experiment_{support::bus_options("experiment")},
      motion_{support::bus_options("motion")};
  runtime::Bus cancellation_{support::bus_options("cancellation")},
      sensing_{support::bus_options("sensing")};
  runtime::Bus recorder_{support::bus_options("recorder")};
  runtime::Bus display_{support::bus_options("display")};
  runtime::Bus operator_{support::bus_options("human_operator")};
  runtime::Bus identification_{support::bus_options("identification")};
  const std::map<std::string_view, runtime::Bus*> own_{
      {"experiment", &experiment_},     {"motion", &motion_},
      {"cancellation", &cancellation_}, {"sensing", &sensing_},
      {"recorder", &recorder_},         {"display", &display_},
      {"human_operator", &operator_},   {"identification", &identification_}};
  std::vector<runtime::Publisher<stillhand_msgs::ServiceStatus>> life_;
  std::atomic<bool> lab_is_dead_{false};
  runtime::Publisher<stillhand_msgs::TrialControl> control_ =
      experiment_.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  runtime::Publisher<stillhand_msgs::SessionSources> sources_ =
      experiment_.publisher<stillhand_msgs::SessionSources>(topics::kSessionSources);
  runtime::Publisher<stillhand_msgs::SessionCommand> request_ =
      experiment_.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand);
  runtime::Publisher<stillhand_msgs::PlatformCommand> platform_ =
      motion_.publisher<stillhand_msgs::PlatformCommand>(topics::kPlatformCommand);
  runtime::Publisher<stillhand_msgs::MotorCommand> motor_ =
      cancellation_.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
  support::Child rig_{
      {STILLHAND_BUILD "/bin/stillhand-rig", "--domain", std::to_string(support::own_domain()),
       "--profiles", kProfiles, "--config", STILLHAND_SOURCE "/deploy/config"},
      std::filesystem::temp_directory_path() / ("stillhand-rig-" + std::to_string(getpid()))};
  std::jthread living_;
};

// The age limit would hide it in the force: motor_tick is -1 as soon as the command counts as none,
// whatever its age.
TEST_F(RigProcessTest, AMissedDeadlineVoidsTheMotorCommandUntilTheNextOne) {
  commands_force_ = true;
  ASSERT_TRUE(eventually([this] { return motor_tick_ >= 100; }));
  commands_force_ = false;
  EXPECT_TRUE(eventually([this] { return motor_tick_ == -1; }));
  commands_force_ = true;
  const Tick void_tick = tick_;
  EXPECT_TRUE(eventually([this, void_tick] { return motor_tick_ >= void_tick; }));
}

TEST_F(RigProcessTest, AfterAnEmergencyStopThePlatformBrakesWhateverMotionCommands) {
  expect_motion();
  stillhand_msgs::SessionCommand stop;
  stop.action(stillhand_msgs::SESSION_EMERGENCY_STOP);
  stop.request(1);
  stop.asker("test");
  request_.write(stop);
  ASSERT_TRUE(eventually([this] { return command_tick_ == kHeld; }));
  expect_rest();
  EXPECT_EQ(command_tick_, kHeld);
}

// The network's or the lab's end: nobody announces that the trial is over, and motion goes on.
TEST_F(RigProcessTest, WithoutTheLabsLifeSignThePlatformBrakesWhateverMotionCommands) {
  expect_motion();
  lab_is_dead_ = true;
  ASSERT_TRUE(eventually([this] { return command_tick_ == kHeld; }));
  expect_rest();
  // Back again: not in this trial.
  lab_is_dead_ = false;
  expect_rest();
  EXPECT_EQ(command_tick_, kHeld);
  announce(2);
  EXPECT_TRUE(eventually([this] { return speed_m_s_ > kMoves_m_s; }));
}

TEST_F(RigProcessTest, WithoutATrialThePlatformHoldsWhateverMotionCommands) {
  expect_motion();
  announce(-1);
  ASSERT_TRUE(eventually([this] { return command_tick_ == kHeld; }));
  expect_rest();
}

TEST_F(RigProcessTest, ATrialThatHasNotBegunIsNoReasonToFollowAMotion) {
  expect_motion();
  announce(2, tick_ + 1'000'000);
  expect_rest();
  EXPECT_NE(command_tick_, kHeld) << "the trial is announced";
  announce(2);
  EXPECT_TRUE(eventually([this] { return speed_m_s_ > kMoves_m_s; }));
}

TEST_F(RigProcessTest, MotionThatFallsSilentIsNotFollowedAgainInTheTrial) {
  expect_motion();
  commands_motion_ = false;
  // A command that is missing, then the end of the permission.
  ASSERT_TRUE(eventually([this] { return command_tick_ == kHeld; }));
  commands_motion_ = true;
  expect_rest();
  EXPECT_EQ(command_tick_, kHeld);
}

TEST_F(RigProcessTest, ARigThatIsAskedToEndBrakesThePlatformFirst) {
  expect_motion();
  EXPECT_EQ(rig_.finish(), 0);
  // The newest sample may still be on its way.
  EXPECT_TRUE(eventually([this] { return speed_m_s_ < kRest_m_s; }));
}

}  // namespace
}  // namespace stillhand
