// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: what a replay writes is marked, and no process of a session takes it,
// nor anything that answers it.
#include <gtest/gtest.h>

#include <atomic>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/playback.hpp"
#include "services/bus/tap.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using support::eventually;

constexpr const char* kProfiles = STILLHAND_SOURCE "/qos/profiles.xml";

Bus::Options options_of(const std::string& service, bool answers_replay = false) {
  Bus::Options options = support::bus_options(service);
  options.answers_replay = answers_replay;
  return options;
}

std::vector<std::byte> command_bytes(Tick tick) {
  stillhand_msgs::MotorCommand command;
  command.rig(1);
  command.tick(tick);
  return to_cdr(command);
}

/// Counts the motor commands that come to a process of the session.
struct Listener {
  explicit Listener(const Bus::Options& options) : bus(options) {
    bus.subscribe<stillhand_msgs::MotorCommand>(
        topics::kMotorCommand, [this](const stillhand_msgs::MotorCommand& message, const Arrival&) {
          ++received;
          newest = message.tick();
        });
    bus.start();
  }
  [[nodiscard]] bool matched(std::uint32_t writers) const {
    return bus.report().front().matched == writers;
  }
  Bus bus;
  std::atomic<int> received{0};
  std::atomic<Tick> newest{-1};
};

class ReplayMarkTest : public testing::Test {
 protected:
  Playback replay{kProfiles, support::own_domain(), "stillhand-replay/test"};
};

WriterQos stream_qos(const Playback& replay) { return *replay.profile("control_loop"); }

TEST_F(ReplayMarkTest, ARigTakesNoCommandOfAReplayAndGoesOnTakingTheCancellations) {
  const std::size_t writer = replay.add_writer("stillhand/motor_command",
                                               "stillhand_msgs::MotorCommand", stream_qos(replay));
  Listener rig(options_of("rig"));
  Listener desk(options_of("identification", true));  // takes replays: the samples do travel
  Bus cancellation(options_of("cancellation"));
  auto genuine = cancellation.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
  cancellation.start();
  ASSERT_TRUE(eventually([&] { return rig.matched(2) && desk.matched(2); }));

  constexpr Tick kReplayed = 7;
  ASSERT_TRUE(eventually([&] {
    replay.write(writer, command_bytes(kReplayed));
    return desk.newest.load() == kReplayed;
  }));
  EXPECT_EQ(rig.received.load(), 0);

  constexpr Tick kGenuine = 8;
  stillhand_msgs::MotorCommand command;
  command.tick(kGenuine);
  ASSERT_TRUE(eventually([&] {
    genuine.write(command);
    return rig.newest.load() == kGenuine;
  }));
}

TEST_F(ReplayMarkTest, ARigTakesNoCommandOfACancellationThatAnswersReplays) {
  Listener rig(options_of("rig"));
  Listener desk(options_of("identification", true));
  Bus cancellation(options_of("cancellation", true));
  auto answer = cancellation.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
  cancellation.start();
  ASSERT_TRUE(eventually([&] { return rig.matched(1) && desk.matched(1); }));
  stillhand_msgs::MotorCommand command;
  ASSERT_TRUE(eventually([&] {
    answer.write(command);
    return desk.received.load() > 0;
  }));
  EXPECT_EQ(rig.received.load(), 0);
}

// Every service of the catalogue shows its life sign, so that the replay alone decides.
TEST_F(ReplayMarkTest, NobodyCountsAsAliveWhileAReplayIsThereAndAgainOnceItLeft) {
  Bus rig(options_of("rig"));
  rig.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus,
                                               [](const auto&, const auto&) {});
  rig.start();
  std::vector<std::unique_ptr<Bus>> others;
  std::vector<Publisher<stillhand_msgs::ServiceStatus>> statuses;
  for (const std::string_view service : topics::kServices) {
    if (service == "rig") continue;
    others.push_back(std::make_unique<Bus>(options_of(std::string(service))));
    statuses.push_back(
        others.back()->publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus));
    others.back()->start();
  }
  const auto sign = [&] {
    for (auto& status : statuses) {
      stillhand_msgs::ServiceStatus message;
      status.write(message);
    }
  };
  // The fixture's replay is there from the beginning.
  ASSERT_TRUE(eventually([&] {
    sign();
    return rig.replay_present() && rig.lost_peers().empty() && rig.report().front().matched == 8;
  }));
  for (int i = 0; i < 20; ++i) {
    sign();
    EXPECT_FALSE(rig.peers_alive());
  }
  {
    const Playback left = std::move(replay);
  }
  ASSERT_TRUE(eventually([&] {
    sign();
    return rig.peers_alive();
  })) << "a replay that has left goes on counting";
  const Playback back(kProfiles, support::own_domain(), "stillhand-replay/back");
  EXPECT_TRUE(eventually([&] {
    sign();
    return !rig.peers_alive();
  }));
}

// Fast DDS 3 returns 0 for a sample that it took, where Fast DDS 2 returned true.
TEST_F(ReplayMarkTest, ASampleThatDdsTookIsNotCountedAsRefused) {
  const std::size_t writer = replay.add_writer("stillhand/motor_command",
                                               "stillhand_msgs::MotorCommand", stream_qos(replay));
  EXPECT_TRUE(replay.write(writer, command_bytes(1)));
}

TEST_F(ReplayMarkTest, BytesThatAreNoMessageAreRefusedOrPassedOnAndHarmNobody) {
  const std::size_t writer = replay.add_writer("stillhand/motor_command",
                                               "stillhand_msgs::MotorCommand", stream_qos(replay));
  Listener desk(options_of("identification", true));
  ASSERT_TRUE(eventually([&] { return desk.matched(1); }));
  replay.write(writer, std::vector<std::byte>(3, std::byte{0xff}));
  replay.write(writer, std::vector<std::byte>(40, std::byte{0xff}));
  EXPECT_TRUE(eventually([&] {
    replay.write(writer, command_bytes(1));
    return desk.newest.load() == 1;
  }));
}

TEST_F(ReplayMarkTest, ATapHearsAReplayWithItsMarkBytesAndQos) {
  WriterQos offered = stream_qos(replay);
  offered.depth = 0;  // does not travel
  offered.keyed = true;
  const std::size_t writer =
      replay.add_writer("another/topic", "stillhand_msgs::MotorCommand", offered);
  std::mutex mutex;
  std::vector<std::byte> heard;
  FoundWriter found;
  Tap::Options options;
  options.name = "stillhand-record/test";
  options.domain = support::own_domain();
  options.profiles = kProfiles;
  options.wanted = [](const std::string& topic) { return topic == "another/topic"; };
  options.on_sample = [&](const FoundWriter& from, const TappedSample& sample) {
    const std::lock_guard lock(mutex);
    found = from;
    heard.assign(sample.bytes.begin(), sample.bytes.end());
  };
  Tap sut(options);
  sut.start();
  const auto sent = command_bytes(12345);
  ASSERT_TRUE(eventually([&] {
    replay.write(writer, sent);
    const std::lock_guard lock(mutex);
    return !heard.empty();
  }));
  sut.stop();
  EXPECT_EQ(heard, sent);
  EXPECT_TRUE(found.replayed);
  EXPECT_EQ(found.topic, "another/topic");
  EXPECT_EQ(found.type, "stillhand_msgs::MotorCommand");
  EXPECT_EQ(found.qos, offered);
  EXPECT_EQ(sut.trouble(), std::vector<std::string>{});
  EXPECT_EQ(sut.unattributed(), 0u);
}

}  // namespace
}  // namespace stillhand::runtime
