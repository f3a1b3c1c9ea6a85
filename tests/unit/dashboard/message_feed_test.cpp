// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/message_feed.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "apps/dashboard/view/snapshot_json.hpp"
#include "idl/control_loop.h"
#include "tests/support/session_file.hpp"

namespace stillhand::dashboard::message_feed_test {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBegin = 1000 * 1000 * kMs;

class MessageFeedTest : public ::testing::Test {
 protected:
  std::uint32_t add(const topics::Topic& topic, MessageFeed& feed, bool replayed = false) {
    const std::string who = replayed ? "replay-5" : std::string(topic.writers.front());
    return feed.add(
        {std::string(topic.name), std::string(topic.type), "stillhand/1/" + who, replayed});
  }
  std::uint32_t add(const topics::Topic& topic) { return add(topic, sut_); }
  template <typename Message_>
  void take(MessageFeed& feed, std::uint32_t source, const Message_& message, std::int64_t at_ms) {
    const auto bytes = to_cdr(message);
    feed.take({source, ++sequence_, kBegin + at_ms * kMs, kBegin + at_ms * kMs, bytes});
  }
  void control(MessageFeed& feed, stillhand_msgs::Phase phase, Tick start_tick) {
    stillhand_msgs::TrialControl control;
    control.rig(1);
    control.session(stillhand_msgs::SESSION_RUNNING);
    control.trial(0);
    control.phase(phase);
    control.start_tick(start_tick);
    control.duration_ticks(10'000);
    take(feed, add(topics::kTrialControl, feed), control, 0);
  }
  void truth(std::uint32_t source, Tick tick) {
    stillhand_msgs::RigTruth truth;
    truth.rig(1);
    truth.tick(tick);
    truth.stamp_ns(tick * kMs);
    truth.motor_tick(-1);
    take(sut_, source, truth, tick);
  }
  void stop_at_once() {
    stillhand_msgs::Event event;
    event.rig(1);
    event.kind(stillhand_msgs::EVENT_INTERLOCK_OPENED);
    event.code(stillhand_msgs::CODE_EMERGENCY_STOP);
    take(sut_,
         sut_.add({std::string(topics::kEvent.name), std::string(topics::kEvent.type),
                   "stillhand/1/rig", false}),
         event, 0);
  }
  TopicReport truths() const { return sut_.health().topics().at(3).report(kBegin); }
  // A second of the rig with a force of the motor, and the hand's that answers it.
  void push(MessageFeed& feed) {
    const std::uint32_t source = add(topics::kRigTruth, feed);
    const std::uint32_t sensing = add(topics::kSensed, feed);
    for (Tick tick = 0; tick < 1000; ++tick) {
      stillhand_msgs::RigTruth truth;
      truth.rig(1);
      truth.tick(tick);
      truth.stamp_ns(tick * kMs);
      truth.motor_tick(-1);
      truth.motor_force_n(7.0);
      take(feed, source, truth, tick);
      stillhand_msgs::Sensed sensed;
      sensed.rig(1);
      sensed.tick(tick);
      sensed.force_n(7.0);
      take(feed, sensing, sensed, tick);
    }
  }
  static bool shows_force(const MessageFeed& feed) {
    for (const auto& row : feed.traces().rows()) {
      for (const Signal each : {Signal::kMotorForce, Signal::kForce}) {
        if (row.values[static_cast<std::size_t>(each)] == 7.0) return true;
      }
    }
    return false;
  }
  static FeedOptions unblinded() {
    FeedOptions options;
    options.blinded = false;
    return options;
  }

  std::uint32_t sequence_ = 0;
  MessageFeed sut_{FeedOptions{}};
};

TEST_F(MessageFeedTest, AnotherRigsMessagesAreNotCounted) {
  const std::uint32_t source = add(topics::kSensed);
  stillhand_msgs::Sensed sensed;
  for (const std::uint32_t rig : {1u, 2u, 1u}) {
    sensed.rig(rig);
    take(sut_, source, sensed, 0);
  }
  EXPECT_EQ(sut_.health().topics().at(1).report(kBegin).samples, 2u);
}

TEST_F(MessageFeedTest, TheRigSaysOfWhichPartsItIsAndAnotherRigsWordsAreForgotten) {
  const std::uint32_t events = add(topics::kEvent), rig = add(topics::kRigTruth);
  truth(rig, 0);
  stillhand_msgs::Event event;
  event.rig(1);
  event.kind(stillhand_msgs::EVENT_NOTE);
  event.source("experiment");
  event.text("rig of devices: a note of a person");
  take(sut_, events, event, 0);
  EXPECT_EQ(sut_.rig_parts(), "");
  event.source("rig");
  event.text("rig of devices: force drive; simulated: platform");
  take(sut_, events, event, 0);
  EXPECT_EQ(sut_.rig_parts(), "force drive; simulated: platform");
  truth(add(topics::kRigTruth), 1);
  EXPECT_EQ(sut_.rig_parts(), "");
}

TEST_F(MessageFeedTest, AReplayBesideASessionIsNotCounted) {
  const std::uint32_t replay = add(topics::kRigTruth, sut_, true);
  truth(replay, 500);
  EXPECT_EQ(truths().samples, 1u);  // as long as nothing else is there
  const std::uint32_t rig = add(topics::kRigTruth);
  truth(rig, 0);
  stop_at_once();
  for (Tick tick = 1; tick < 10; ++tick) {
    truth(replay, 500 + tick);
    truth(rig, tick);
    truth(add(topics::kRigTruth, sut_, true), 900 + tick);
  }
  EXPECT_EQ(truths().samples, 10u);
  EXPECT_EQ(truths().first_tick, 0);
  EXPECT_EQ(truths().last_tick, 9);
  EXPECT_EQ(sut_.newest_tick(), 9);
  EXPECT_EQ(sut_.emergency_ns(), kBegin);
  EXPECT_TRUE(sut_.replayed());
}

TEST_F(MessageFeedTest, AnEmergencyStopIsForgottenWithItsRigAlone) {
  const std::uint32_t before = add(topics::kRigTruth), rig = add(topics::kRigTruth);
  truth(before, 0);
  truth(rig, 0);
  stop_at_once();
  for (Tick tick = 1; tick < 10; ++tick) {
    truth(before, tick);
    truth(rig, tick);
  }
  EXPECT_EQ(sut_.emergency_ns(), kBegin);
  truth(before, 2000);  // the other one ended; nobody started it anew
  EXPECT_EQ(sut_.newest_tick(), 2000);
  EXPECT_EQ(sut_.emergency_ns(), kBegin);
  truth(add(topics::kRigTruth), 0);
  EXPECT_EQ(sut_.emergency_ns(), 0);
}

TEST_F(MessageFeedTest, WhileAPersonTracksTheMotorsForceStaysHidden) {
  control(sut_, stillhand_msgs::PHASE_TRACKING, 100);
  push(sut_);
  EXPECT_FALSE(shows_force(sut_));
  EXPECT_FALSE(sut_.wants(std::string(topics::kTrialAssignment.name)));
}

// A page that is opened in the middle of a trial hears of it later than of its samples.
TEST_F(MessageFeedTest, BeforeATrialIsHeardOfTheMotorsForceStaysHidden) {
  push(sut_);
  EXPECT_FALSE(shows_force(sut_));
  MessageFeed open{unblinded()};
  push(open);
  EXPECT_TRUE(shows_force(open));
}

// A stop ends the announcement first, and then the force: 40 ms at most, and nobody counts them.
TEST_F(MessageFeedTest, TheEndOfAForceStaysHiddenToo) {
  MessageFeed open{unblinded()};
  for (MessageFeed* feed : {&sut_, &open}) {
    control(*feed, stillhand_msgs::PHASE_TRACKING, 100);
    control(*feed, stillhand_msgs::PHASE_IDLE, 0);
    push(*feed);  // a second of it
    EXPECT_EQ(shows_force(*feed), feed == &open);
  }
}

// 0 without a force, up to 39 ms with one.
TEST_F(MessageFeedTest, TheTimeToZeroForceIsToldToTheUnblindedAlone) {
  MessageFeed open{unblinded()};
  for (MessageFeed* feed : {&sut_, &open}) {
    stillhand_msgs::Event event;
    event.rig(1);
    event.source("rig");
    event.kind(stillhand_msgs::EVENT_INTERLOCK_OPENED);
    const std::uint32_t source = add(topics::kEvent, *feed);
    take(*feed, source, event, 0);
    event.kind(stillhand_msgs::EVENT_FORCE_ZERO);
    event.tick(39);
    event.by_us(39'000.0);
    take(*feed, source, event, 39);
    ASSERT_EQ(feed->events().size(), 2u);
    const HeardEvent& zero = feed->events().front();
    const bool hidden = feed == &sut_;
    EXPECT_EQ(zero.event.by_us(), hidden ? 0.0 : 39'000.0);
    EXPECT_EQ(zero.event.tick(), hidden ? -1 : 39);
    EXPECT_EQ(zero.at_ns, hidden ? kBegin : kBegin + 39 * kMs);
  }
}

TEST_F(MessageFeedTest, OutsideOfATrialOfAPersonAndUnblindedItIsShown) {
  MessageFeed pegged{FeedOptions{}}, open{unblinded()};
  control(pegged, stillhand_msgs::PHASE_PEGGED, 100);
  push(pegged);
  EXPECT_TRUE(shows_force(pegged));
  control(open, stillhand_msgs::PHASE_TRACKING, 100);
  push(open);
  EXPECT_TRUE(shows_force(open));
}

TEST_F(MessageFeedTest, TheConditionIsToldToTheUnblindedAlone) {
  MessageFeed open{unblinded()};
  for (MessageFeed* feed : {&sut_, &open}) {
    stillhand_msgs::TrialAssignment assignment;
    assignment.rig(1);
    assignment.motion(stillhand_msgs::MOTION_BAND_NOISE);
    assignment.cancellation(true);
    take(*feed, add(topics::kTrialAssignment, *feed), assignment, 0);
  }
  EXPECT_EQ(open.condition(), "motion, cancellation");
  EXPECT_EQ(sut_.condition(), "");
  EXPECT_EQ(snapshot_json(sut_, {}, kBegin, -1).find("trial_assignment"), std::string::npos);
}

class ProtocolTest : public MessageFeedTest {
 protected:
  void show(stillhand_msgs::PromptKind kind, Tick end_tick, int steps = 0) {
    stillhand_msgs::Prompt prompt;
    prompt.rig(1);
    prompt.number(++number_);
    prompt.kind(kind);
    prompt.participant("P07");
    prompt.block(1);
    prompt.blocks(2);
    prompt.trial(4);
    prompt.trials(12);
    prompt.end_tick(end_tick);
    prompt.steps(steps);
    take(sut_, add(topics::kPrompt), prompt, 0);
  }
  nlohmann::json protocol() {
    return nlohmann::json::parse(snapshot_json(sut_, {}, kBegin, -1)).at("session").at("protocol");
  }
  void expect(const char* waits_for, const nlohmann::json& left_s) {
    EXPECT_EQ(protocol().at("waits_for"), waits_for);
    EXPECT_EQ(protocol().at("left_s"), left_s);
  }
  std::uint64_t number_ = 0;
};

TEST_F(ProtocolTest, PlaceAndWaitOfTheSessionAreShownAndNoCondition) {
  control(sut_, stillhand_msgs::PHASE_TRACKING, 100);  // measured up to tick 10100
  const std::uint32_t rig = add(topics::kRigTruth);
  truth(rig, 4100);
  EXPECT_TRUE(protocol().is_null());
  show(stillhand_msgs::PROMPT_TRIAL, 100);
  expect("trial", 6.0);
  EXPECT_EQ(protocol().at("participant"), "P07");
  EXPECT_EQ(protocol().at("trial"), 4);
  EXPECT_EQ(protocol().at("trials"), 12);
  EXPECT_EQ(protocol().size(), 8u);  // kind, participant, places and the wait
  truth(rig, 20'000);
  expect("", nullptr);
  show(stillhand_msgs::PROMPT_TRIAL, 25'000);
  expect("rest", 5.0);
  show(stillhand_msgs::PROMPT_BREAK, 140'000);
  expect("break", 120.0);
  show(stillhand_msgs::PROMPT_QUESTION, -1, 7);
  expect("participant", nullptr);
}

TEST_F(MessageFeedTest, AnotherHostsClockIsTakenOffItsLatencies) {
  stillhand_msgs::ClockOffset offset;
  offset.rig(1);
  offset.service("sensing");
  offset.system_offset_ns(5 * kMs);
  take(sut_, add(topics::kClockOffset), offset, 0);
  stillhand_msgs::Sensed sensed;
  sensed.rig(1);
  const auto bytes = to_cdr(sensed);
  sut_.take({add(topics::kSensed), 1, kBegin + 5 * kMs, kBegin + kMs, bytes});
  EXPECT_EQ(sut_.health().topics().at(1).report(kBegin).latency.max_ns, kMs);
}

// The experiment, last in the catalogue, is gone: its last word is the oldest.
TEST_F(MessageFeedTest, OfAHostsProcessesTheNewestWordIsTold) {
  int at_ms = 0;
  for (const auto& [service, share] :
       {std::pair{"experiment", 0.9}, {"rig", 0.7}, {"sensing", 0.25}}) {
    stillhand_msgs::HostStatus host;
    host.rig(1);
    host.service(service);
    host.host("rig-pc");
    host.cores(4);
    host.host_cpu_share(share);
    take(sut_, add(topics::kHostStatus), host, ++at_ms);
  }
  const auto hosts = nlohmann::json::parse(snapshot_json(sut_, {}, kBegin, -1)).at("hosts");
  ASSERT_EQ(hosts.size(), 1u);
  EXPECT_EQ(hosts[0].at("services"), nlohmann::json({"rig", "sensing", "experiment"}));
  EXPECT_EQ(hosts[0].at("cpu_share"), 0.25);
}

TEST_F(MessageFeedTest, BytesThatAreNoMessageAreCountedAndHarmNothing) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> sources;
  for (const topics::Topic* topic : topics::kCatalogue) sources.push_back(add(*topic));
  sources.push_back(sut_.add({"stranger/topic", "stranger::Type", "", false}));
  for (std::uint32_t i = 0; i < 50'000; ++i) {
    std::vector<std::byte> bytes(random() % 200);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 256);
    // Right up to the rig's number, so that it is looked into.
    if (bytes.size() > 8) {
      for (std::size_t at = 0; at < 8; ++at) bytes[at] = std::byte{0};
      bytes[1] = bytes[4] = std::byte{1};
    }
    sut_.take({sources[random() % sources.size()], i, kBegin, kBegin + i * kMs, bytes});
  }
  EXPECT_GT(sut_.malformed(), 0u);
  EXPECT_LE(sut_.events().size(), 50u);
  // Whatever texts came: it is JSON.
  EXPECT_TRUE(nlohmann::json::accept(snapshot_json(sut_, {}, kBegin, -1)));
}

}  // namespace stillhand::dashboard::message_feed_test
