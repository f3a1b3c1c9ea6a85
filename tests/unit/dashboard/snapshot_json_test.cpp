// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/view/snapshot_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/dashboard/view/view_json.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::dashboard::snapshot_json_test {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBegin = 1000 * 1000 * kMs;

class SnapshotJsonTest : public ::testing::Test {
 protected:
  std::uint32_t add(const topics::Topic& topic) {
    return sut_.add({std::string(topic.name), std::string(topic.type),
                     "stillhand/1/" + std::string(topic.writers.front()), false});
  }
  template <typename Message_>
  void take(std::uint32_t source, const Message_& message, std::int64_t at_ms) {
    const auto bytes = to_cdr(message);
    sut_.take({source, ++sequences_[source], kBegin + at_ms * kMs, kBegin + at_ms * kMs, bytes});
  }
  void control(stillhand_msgs::SessionState state, stillhand_msgs::Phase phase) {
    stillhand_msgs::TrialControl control;
    control.rig(1);
    control.session(state);
    control.phase(phase);
    control.trial(3);
    control.start_tick(5000);
    control.duration_ticks(60'000);
    take(add(topics::kTrialControl), control, 0);
  }
  nlohmann::json snapshot(const Surroundings& around = {}, Tick after = -1, Parts parts = {}) {
    return nlohmann::json::parse(snapshot_json(sut_, around, kBegin + 10'000 * kMs, after, parts));
  }

  std::map<std::uint32_t, std::uint32_t> sequences_;  // of each writer
  MessageFeed sut_{FeedOptions{}};
};

TEST_F(SnapshotJsonTest, BeforeTheFirstMessageItIsCompleteAndHealthy) {
  const auto json = snapshot();
  EXPECT_EQ(json.at("level"), "healthy");
  EXPECT_EQ(json.at("session").at("state"), "none");
  EXPECT_FALSE(json.at("session").contains("trial"));
  EXPECT_EQ(json.at("services").size(), topics::kServices.size());
  for (const auto& service : json.at("services")) {
    EXPECT_TRUE(service.at("last_ms").is_null());
    EXPECT_FALSE(service.contains("state"));
  }
  for (const char* empty : {"alarms", "events", "recorders", "clocks", "hosts", "rigs"}) {
    EXPECT_TRUE(json.at(empty).empty()) << empty;
  }
  for (const auto& topic : json.at("topics")) {
    EXPECT_EQ(topic.at("samples"), 0);
    EXPECT_TRUE(topic.at("first_ms").is_null());
    EXPECT_EQ(topic.at("jitter_counts").size(), json.at("jitter_edges_us").size());
  }
}

TEST_F(SnapshotJsonTest, TheSessionIsShownWithItsTrial) {
  control(stillhand_msgs::SESSION_PAUSED, stillhand_msgs::PHASE_TRACKING);
  const auto session = snapshot().at("session");
  EXPECT_EQ(session.at("state"), "paused");
  EXPECT_EQ(session.at("paused"), true);
  EXPECT_EQ(session.at("phase"), "tracking");
  EXPECT_EQ(session.at("trial"), 3);
  EXPECT_EQ(session.at("start_tick"), 5000);
  EXPECT_EQ(session.at("duration_ticks"), 60'000);
  EXPECT_FALSE(session.contains("condition")) << "blinded";
}

// Trial 3 is measured from tick 5000 on, and is announced before its motion begins.
TEST_F(SnapshotJsonTest, ThePlatformEngagesFromTheAnnouncementToTheFirstRamp) {
  control(stillhand_msgs::SESSION_RUNNING, stillhand_msgs::PHASE_TRACKING);
  EXPECT_EQ(snapshot().at("session").at("engaging"), true);
  control(stillhand_msgs::SESSION_RUNNING, stillhand_msgs::PHASE_IDLE);
  EXPECT_EQ(snapshot().at("session").at("engaging"), false);
}

// Enumerations come from the bus and can hold any number.
TEST_F(SnapshotJsonTest, NumbersThatTheIdlDoesNotDefineAreUnknown) {
  control(static_cast<stillhand_msgs::SessionState>(77), static_cast<stillhand_msgs::Phase>(99));
  const auto session = snapshot().at("session");
  EXPECT_EQ(session.at("state"), "unknown");
  EXPECT_EQ(session.at("phase"), "unknown");
}

TEST_F(SnapshotJsonTest, TheWorstAlarmStandsFirstWithItsWriterAndUnit) {
  control(stillhand_msgs::SESSION_RUNNING, stillhand_msgs::PHASE_PEGGED);
  const std::uint32_t sensed = add(topics::kSensed), raw = add(topics::kRawSample);
  for (Tick tick = 0; tick < 3000; ++tick) {
    stillhand_msgs::Sensed first;
    first.rig(1);
    first.tick(tick);
    first.stamp_ns(tick * kMs);
    stillhand_msgs::RawSample second;
    second.rig(1);
    second.tick(tick);
    second.stamp_ns(tick * kMs);
    if (tick < 2900 || tick > 2902) take(raw, second, tick);    // 3 ticks: a warning
    if (tick < 2950 || tick > 2969) take(sensed, first, tick);  // 20 ticks: critical
  }
  const auto json = snapshot();
  EXPECT_EQ(json.at("level"), "critical");
  ASSERT_GE(json.at("alarms").size(), 2u);
  const auto& worst = json.at("alarms")[0];
  EXPECT_EQ(worst.at("watch"), "lost");
  EXPECT_EQ(worst.at("subject"), "stillhand/sensed");
  EXPECT_EQ(worst.at("writer"), "sensing");
  EXPECT_EQ(worst.at("unit"), "ticks");
  EXPECT_EQ(worst.at("level"), "critical");
  EXPECT_EQ(worst.at("worst"), 20.0);
  bool warned = false;
  for (const auto& alarm : json.at("alarms")) {
    if (alarm.at("level") == "warning") warned = true;
    EXPECT_FALSE(warned && alarm.at("level") == "critical") << "a worse one stands behind";
  }
  EXPECT_TRUE(warned);
}

TEST_F(SnapshotJsonTest, TextsThatAreNotUtf8AndNumbersThatAreNotFiniteAreStillJson) {
  stillhand_msgs::Event event;
  event.rig(1);
  event.kind(stillhand_msgs::EVENT_NOTE);
  event.text("\xff\xfe \"quoted\"\n");
  event.by_us(std::numeric_limits<double>::quiet_NaN());
  take(add(topics::kEvent), event, 1);
  Surroundings around;
  around.file = "\xc3";
  around.cpu_share = std::numeric_limits<double>::infinity();
  const auto json = snapshot(around);
  ASSERT_EQ(json.at("events").size(), 1u);
  EXPECT_TRUE(json.at("events")[0].at("by_us").is_null());
  EXPECT_THAT(json.at("events")[0].at("text").get<std::string>(),
              testing::EndsWith(" \"quoted\"\n"));
  EXPECT_TRUE(json.at("dashboard").at("cpu_share").is_null());
}

TEST_F(SnapshotJsonTest, OfManyEventsTheNewestTwentyAreShownNewestFirst) {
  const std::uint32_t source = add(topics::kEvent);
  for (int i = 0; i < 30; ++i) {
    stillhand_msgs::Event event;
    event.rig(1);
    event.kind(stillhand_msgs::EVENT_NOTE);
    event.text(std::to_string(i).c_str());
    take(source, event, i);
  }
  const auto events = snapshot().at("events");
  ASSERT_EQ(events.size(), 20u);
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].at("text"), std::to_string(29 - i));
  }
}

TEST_F(SnapshotJsonTest, TracesAreRoundedToTenMicronewtonsAndBeginBehindTheGivenTick) {
  const std::uint32_t source = add(topics::kSensed);
  for (Tick tick = 0; tick <= 400; ++tick) {
    stillhand_msgs::Sensed sensed;
    sensed.rig(1);
    sensed.tick(tick);
    sensed.accel_y_m_s2(1.0 / 3.0);
    take(source, sensed, tick);
  }
  const auto traces = snapshot({}, 200).at("traces");
  EXPECT_EQ(traces.at("tick"), nlohmann::json({220, 240, 260, 280, 300, 320, 340}));
  for (const auto& value : traces.at("accel_y_m_s2")) EXPECT_EQ(value, 0.33333);
  for (const auto& value : traces.at("cursor_m")) EXPECT_TRUE(value.is_null());
}

// A process reports its status ten times for each report of its host.
TEST_F(SnapshotJsonTest, AStatusKeepsTheTimeOfTheReportOfItsHost) {
  int at_ms = 0;
  for (const auto& [service, share] : {std::pair{"experiment", 0.9}, {"rig", 0.25}}) {
    stillhand_msgs::HostStatus host;
    host.rig(1);
    host.service(service);
    host.host("rig-pc");
    host.host_cpu_share(share);
    take(add(topics::kHostStatus), host, ++at_ms);
  }
  for (const char* service : {"experiment", "rig"}) {
    stillhand_msgs::ServiceStatus status;
    status.rig(1);
    status.service(service);
    status.pid(7);
    take(add(topics::kServiceStatus), status, ++at_ms);
  }
  const auto hosts = snapshot().at("hosts");
  ASSERT_EQ(hosts.size(), 1u);
  EXPECT_EQ(hosts[0].at("cpu_share"), 0.25) << "the rig reported last";
}

TEST_F(SnapshotJsonTest, PartsThatAreNotAskedForAreLeftOut) {
  EXPECT_TRUE(snapshot().contains("graph"));
  EXPECT_TRUE(snapshot().contains("spectrum"));
  const auto json = snapshot({}, -1, {.graph = false, .spectrum = false});
  EXPECT_FALSE(json.contains("graph"));
  EXPECT_FALSE(json.contains("spectrum"));
}

TEST(TimelineJsonTest, AnInstantOfAMarkIsAtMostAMicrosecondLateAndNeverEarly) {
  const std::vector<std::int64_t> offsets_ns{0, 1, 999, 1000, 1001, 59'999'999'999};
  for (const std::int64_t offset_ns : offsets_ns) {
    Timeline sut(kBegin, kBegin + 60'000 * kMs);
    sut.mark(MarkKind::kLost,
             {kBegin + offset_ns, Level::kCritical, 1, "stillhand/sensed", "", 4.0});
    const Json marks = timeline_json(sut).at("marks");
    ASSERT_EQ(marks.at("lost").size(), 1u);
    const double at_s = marks.at("lost")[0].at("at_s");
    // A double of up to 60 s resolves 7e-15 s; 1e-12 s covers its rounding.
    EXPECT_GE(at_s, static_cast<double>(offset_ns) * 1e-9 - 1e-12) << offset_ns;
    EXPECT_LE(at_s, static_cast<double>(offset_ns) * 1e-9 + 1e-6) << offset_ns;
    EXPECT_EQ(marks.at("lost")[0].at("writer"), "sensing");
    EXPECT_EQ(marks.at("lost")[0].at("level"), "critical");
    EXPECT_TRUE(marks.at("late").empty());
  }
}

TEST(TimelineJsonTest, AnAmountThatIsNotFiniteIsNullAndTrialsHaveTheirPhase) {
  Timeline sut(kBegin, kBegin + 60'000 * kMs);
  sut.mark(MarkKind::kEvent, {kBegin, Level::kHealthy, 1, "rig", "note", std::nan("")});
  sut.announce({2, TrialPhase::kPegged, 1000, 500, 0}, kBegin);
  sut.tick(1000, kBegin + 1000 * kMs);
  sut.tick(1500, kBegin + 1500 * kMs);
  const Json json = timeline_json(sut);
  EXPECT_TRUE(json.at("marks").at("event")[0].at("amount").is_null());
  ASSERT_EQ(json.at("trials").size(), 1u);
  EXPECT_EQ(json.at("trials")[0].at("phase"), "pegged");
  EXPECT_EQ(json.at("trials")[0].at("from_s"), 1.0);
  EXPECT_EQ(json.at("trials")[0].at("to_s"), 1.5);
  EXPECT_EQ(json.at("length_s"), 60.0);
}

TEST(TimelineJsonTest, NeverIsNullAndEveryOtherInstantIsMilliseconds) {
  EXPECT_TRUE(instant(0).is_null());
  EXPECT_EQ(instant(1'500'000), 1.5);
  EXPECT_EQ(instant(-kMs), -1.0);
  EXPECT_TRUE(number(std::nan("")).is_null());
  EXPECT_TRUE(number(-std::numeric_limits<double>::infinity()).is_null());
  EXPECT_EQ(number(-0.5), -0.5);
}

}  // namespace stillhand::dashboard::snapshot_json_test
