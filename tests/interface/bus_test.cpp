// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: profiles load, endpoints match, samples arrive, peers are named.
#include "services/bus/bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <set>

#include "idl/clock.h"
#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/recording.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using support::eventually;

template <typename Message>
void expect_delivery(const topics::Topic& topic) {
  Bus writer(support::bus_options("motion"));
  Bus reader(support::bus_options("rig"));
  std::atomic<int> received{0};
  auto publisher = writer.publisher<Message>(topic);
  reader.subscribe<Message>(topic, [&](const Message&, const Arrival&) { ++received; });
  writer.start();
  reader.start();
  ASSERT_TRUE(eventually([&] {
    return reader.report().front().matched == 1 && writer.report().front().matched == 1;
  })) << topic.name;
  Message message;
  ASSERT_TRUE(eventually([&] {
    publisher.write(message);
    return received.load() > 0;
  })) << topic.name;
}

TEST(BusTest, EveryTopicOfTheCatalogueMatchesAndDelivers) {
  using namespace stillhand_msgs;
  expect_delivery<PlatformCommand>(topics::kPlatformCommand);
  expect_delivery<RawSample>(topics::kRawSample);
  expect_delivery<RigTruth>(topics::kRigTruth);
  expect_delivery<Sensed>(topics::kSensed);
  expect_delivery<MotorCommand>(topics::kMotorCommand);
  expect_delivery<TrackingSample>(topics::kTrackingSample);
  expect_delivery<OperatorForce>(topics::kOperatorForce);
  expect_delivery<Pointer>(topics::kPointer);
  expect_delivery<TrialControl>(topics::kTrialControl);
  expect_delivery<TrialAssignment>(topics::kTrialAssignment);
  expect_delivery<FeedthroughModel>(topics::kFeedthroughModel);
  expect_delivery<AugmentedModel>(topics::kAugmentedModel);
  expect_delivery<Event>(topics::kEvent);
  expect_delivery<ServiceStatus>(topics::kServiceStatus);
  expect_delivery<ClockQuestion>(topics::kClockQuestion);
  expect_delivery<ClockAnswer>(topics::kClockAnswer);
  expect_delivery<ClockOffset>(topics::kClockOffset);
  expect_delivery<HostStatus>(topics::kHostStatus);
  expect_delivery<SessionCommand>(topics::kSessionCommand);
  expect_delivery<SessionSources>(topics::kSessionSources);
  expect_delivery<Prompt>(topics::kPrompt);
  expect_delivery<Answer>(topics::kAnswer);
  expect_delivery<RecorderCommand>(topics::kRecorderCommand);
}

TEST(BusTest, WhoComesLaterHearsNoCommandOfBeforeAndIsNamedToWhoAsks) {
  Bus asker(support::bus_options("remote-1"));
  auto publisher = asker.publisher<stillhand_msgs::RecorderCommand>(topics::kRecorderCommand);
  asker.start();
  stillhand_msgs::RecorderCommand command;
  command.request(1);
  publisher.write(command);
  Bus recorder(support::bus_options("record-2"));
  std::atomic<std::uint64_t> first{0};
  recorder.subscribe<stillhand_msgs::RecorderCommand>(
      topics::kRecorderCommand, [&](const stillhand_msgs::RecorderCommand& m, const Arrival&) {
        if (first == 0) first = m.request();
      });
  EXPECT_TRUE(asker.matched_peers(topics::kRecorderCommand).empty());
  recorder.start();
  ASSERT_TRUE(eventually([&] {
    return asker.matched_peers(topics::kRecorderCommand) == std::set<std::string>{"record-2"};
  }));
  command.request(2);
  publisher.write(command);
  ASSERT_TRUE(eventually([&] { return first != 0; }));  // reliable, so in order
  EXPECT_EQ(first, 2u);
}

TEST(BusTest, ALateJoinerGetsTheLatchedState) {
  Bus writer(support::bus_options("experiment"));
  auto publisher = writer.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  writer.start();
  stillhand_msgs::TrialControl message;
  message.trial(7);
  publisher.write(message);
  Bus reader(support::bus_options("rig"));
  std::atomic<int> trial{-1};
  reader.subscribe<stillhand_msgs::TrialControl>(
      topics::kTrialControl,
      [&](const stillhand_msgs::TrialControl& m, const Arrival&) { trial = m.trial(); });
  reader.start();
  EXPECT_TRUE(eventually([&] { return trial.load() == 7; }));
}

TEST(BusTest, TheRecordersBytesAreTheMessage) {
  auto options = support::bus_options("recorder");
  options.serialized = true;
  Bus recorder(options);
  Bus writer(support::bus_options("sensing"));
  std::atomic<std::size_t> size{0};
  recorder.subscribe_serialized(topics::kSensed,
                                [&](std::span<const std::byte> bytes, const Arrival&) {
                                  size = bytes.size();
                                  return detail::SampleClock{true, -1, 0};
                                });
  auto publisher = writer.publisher<stillhand_msgs::Sensed>(topics::kSensed);
  recorder.start();
  writer.start();
  ASSERT_TRUE(eventually([&] {
    stillhand_msgs::Sensed message;
    publisher.write(message);
    return size.load() > 0;
  }));
  // 4 encapsulation, then rig 4 (+4), tick, stamp, acquired 3 x 8, seven doubles, flags 4.
  EXPECT_EQ(size.load(), 4u + 8u + 3u * 8u + 7u * 8u + 4u);
}

TEST(BusTest, NamesThePeersThatAreMissing) {
  Bus sut(support::bus_options("sensing"));
  sut.subscribe<stillhand_msgs::RawSample>(topics::kRawSample, [](const auto&, const auto&) {});
  sut.start();
  EXPECT_THAT(sut.missing_peers(), testing::ElementsAre("rig (stillhand/raw_sample)"));
  Bus rig(support::bus_options("rig"));
  rig.publisher<stillhand_msgs::RawSample>(topics::kRawSample);
  rig.start();
  EXPECT_TRUE(eventually([&] { return sut.missing_peers().empty(); }));
}

TEST(BusTest, SaysWhenAServiceIsThereTwice) {
  Bus first(support::bus_options("rig"));
  Bus second(support::bus_options("rig"));
  first.start();
  second.start();
  EXPECT_TRUE(
      eventually([&] { return first.duplicate_peers() == std::vector<std::string>{"rig"}; }));
}

TEST(BusTest, AnotherRigsSamplesAreNotDelivered) {
  auto other = support::bus_options("motion");
  other.rig = 2;
  Bus writer(other);
  Bus reader(support::bus_options("rig"));
  std::atomic<int> received{0};
  auto publisher = writer.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  reader.subscribe<stillhand_msgs::TrialControl>(topics::kTrialControl,
                                                 [&](const auto&, const auto&) { ++received; });
  // The same reader hears its own rig afterwards: silence alone would prove nothing.
  Bus own(support::bus_options("experiment"));
  auto own_publisher = own.publisher<stillhand_msgs::TrialControl>(topics::kTrialControl);
  writer.start();
  reader.start();
  own.start();
  // A reader that has matched a writer is not yet matched by it, and only then is anything sent.
  ASSERT_TRUE(eventually([&] {
    return reader.report().front().matched == 2 && writer.report().front().matched == 1 &&
           own.report().front().matched == 1;
  }));
  stillhand_msgs::TrialControl message;
  publisher.write(message);
  own_publisher.write(message);
  ASSERT_TRUE(eventually([&] { return received.load() > 0; }));
  EXPECT_EQ(received.load(), 1);
}

/// A reader of motor commands, and how often it reported their absence.
struct CommandReader {
  explicit CommandReader(const std::string& service) : bus(options_of(service)) {
    bus.subscribe<stillhand_msgs::MotorCommand>(topics::kMotorCommand,
                                                [this](const auto&, const auto&) { ++received; });
    bus.supervise(true);
    bus.start();
  }

  std::atomic<int> received{0};
  std::atomic<int> missed{0};
  Bus bus;

 private:
  Bus::Options options_of(const std::string& service) {
    auto options = support::bus_options(service);
    options.on_incident = [this](const BusIncident& incident) {
      if (incident.kind == stillhand_msgs::EVENT_DEADLINE_MISSED) ++missed;
    };
    return options;
  }
};

TEST(BusTest, DdsTellsTheRigOfSilenceAndOtherReadersLookForIt) {
  CommandReader rig("rig");
  CommandReader screen("display");
  Bus writer(support::bus_options("cancellation"));
  auto publisher = writer.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
  writer.start();
  screen.bus.note_silence();  // never a sample yet
  ASSERT_TRUE(eventually([&] {
    stillhand_msgs::MotorCommand message;
    publisher.write(message);
    return rig.received > 0 && screen.received > 0;
  }));
  ASSERT_TRUE(eventually([&] { return rig.missed > 0; }));
  EXPECT_EQ(screen.missed, 0);
  EXPECT_TRUE(eventually([&] {
    screen.bus.note_silence();
    return screen.missed == 1;
  }));
  screen.bus.supervise(false);
  screen.bus.note_silence();
  EXPECT_EQ(screen.missed, 1);
  EXPECT_EQ(screen.bus.report().front().deadline_misses, 1u);
}

TEST(BusTest, ADomainOutOfRangeIsTheOperatorsToMend) {
  auto options = support::bus_options("rig");
  options.domain = 233;
  EXPECT_THROW(Bus{options}, ConfigError);
}

TEST(BusTest, AMissingProfileFileIsNamed) {
  auto options = support::bus_options("rig");
  options.profiles = "/nowhere/profiles.xml";
  EXPECT_THAT(support::refusal([&] { Bus sut(options); }),
              testing::HasSubstr("/nowhere/profiles.xml"));
}

}  // namespace
}  // namespace stillhand::runtime
