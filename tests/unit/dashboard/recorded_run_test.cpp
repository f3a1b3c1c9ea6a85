// SPDX-License-Identifier: Apache-2.0
// The page's counts of a bus are those of its recording, at its end and at any instant of it.
#include "apps/dashboard/feed/recorded_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/dashboard/view/snapshot_json.hpp"
#include "apps/dashboard/view/view_json.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/session_file.hpp"

namespace stillhand::dashboard::recorded_run_test {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBegin = 1'700'000'000'000 * kMs;
constexpr Tick kTicks = 40'000;  // more seconds than states are kept

// The head of a 1 kHz message; what follows matters to no count of a topic.
std::vector<std::byte> head(Tick tick, std::int64_t stamp_ns) {
  std::vector<std::byte> bytes(200);
  const std::uint32_t rig = 1;
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 4, &rig, sizeof(rig));
  std::memcpy(bytes.data() + 12, &tick, sizeof(tick));
  std::memcpy(bytes.data() + 20, &stamp_ns, sizeof(stamp_ns));
  return bytes;
}

struct Recorded {
  std::size_t source;  // of the session below
  std::uint32_t sequence;
  std::int64_t sent_ns, arrived_ns;
  std::vector<std::byte> bytes;
};

const std::vector<Source> kSources{
    {"stillhand/sensed", "stillhand_msgs::Sensed", "stillhand/1/sensing", false},
    {"stillhand/raw_sample", "stillhand_msgs::RawSample", "stillhand/1/rig", false},
    {"stillhand/trial_control", "stillhand_msgs::TrialControl", "stillhand/1/experiment", false},
    {"stillhand/event", "stillhand_msgs::Event", "stillhand/1/sensing", false}};

// Losses, late samples, an event, a trial; and arrivals out of order, as two threads of a recorder
// may write them: half of all places are no clean cut.
std::vector<Recorded> session() {
  std::vector<Recorded> all;
  stillhand_msgs::TrialControl control;
  control.rig(1);
  control.session(stillhand_msgs::SESSION_RUNNING);
  control.trial(3);
  control.phase(stillhand_msgs::PHASE_PEGGED);
  control.start_tick(5000);
  control.duration_ticks(10'000);
  all.push_back({2, 1, kBegin, kBegin, to_cdr(control)});
  for (Tick tick = 0; tick < kTicks; ++tick) {
    for (const std::size_t source : {std::size_t{0}, std::size_t{1}}) {
      if (source == 0 && tick % 7000 == 3) continue;               // lost
      const std::int64_t late = tick % 9000 == 7 ? 4'321'987 : 0;  // sent late
      const std::int64_t sent = kBegin + tick * kMs + late;
      const std::int64_t swapped = source == 1 && tick % 10 == 0 ? -5 * kMs : 0;
      const std::int64_t arrived = sent + 90'000 + (tick * 7919) % 50'000 + swapped;
      all.push_back(
          {source, static_cast<std::uint32_t>(tick), sent, arrived, head(tick, tick * kMs + late)});
    }
    if (tick != 20'000) continue;
    stillhand_msgs::Event event;
    event.rig(1);
    event.kind(stillhand_msgs::EVENT_LIVELINESS_LOST);
    event.source("sensing");
    all.push_back({3, 1, kBegin + tick * kMs, kBegin + tick * kMs + 700'000, to_cdr(event)});
  }
  return all;
}

class RecordedRunTest : public ::testing::Test {
 protected:
  void record(const std::vector<Recorded>& messages) { record(messages, file_); }
  void record(const std::vector<Recorded>& messages, const std::string& file) {
    recording::FileSink sink(file);
    recording::McapWriter writer(sink, {100'000, recording::Compression::kZstd, "stillhand-test"});
    std::vector<recording::ChannelId> channels;
    for (const Source& source : kSources) {
      const auto schema = writer.add_schema(source.type, "omgidl", "");
      channels.push_back(
          writer.add_channel(source.topic, schema, "cdr", {{"participant", source.participant}}));
    }
    for (const Recorded& each : messages) {
      const auto written = writer.write(channels[each.source], each.sequence,
                                        static_cast<std::uint64_t>(each.arrived_ns),
                                        static_cast<std::uint64_t>(each.sent_ns), each.bytes);
      ASSERT_TRUE(written.ok());
    }
    ASSERT_TRUE(writer.close().ok());
  }
  // Everything that is shown, but the plot's lines.
  static nlohmann::json shown(const MessageFeed& feed, std::int64_t now_ns) {
    return nlohmann::json::parse(snapshot_json(feed, {}, now_ns, -1));
  }

  const support::Folder folder_;
  std::string file_ = folder_ / "run.mcap";
  std::string cut_file_ = file_ + ".cut";
};

TEST_F(RecordedRunTest, CountsAreThoseOfTheBusToTheLastDigit) {
  const std::vector<Recorded> messages = session();
  record(messages);
  MessageFeed live{FeedOptions{}};
  for (const Source& source : kSources) live.add(source);
  for (const Recorded& each : messages) {
    live.take({static_cast<std::uint32_t>(each.source), each.sequence, each.sent_ns,
               each.arrived_ns, each.bytes});
  }
  RecordedRun sut(file_, FeedOptions{}, {});
  const std::int64_t end_ns = sut.timeline().end_ns();
  const auto topics = shown(live, end_ns).at("topics");
  EXPECT_EQ(topics, shown(sut.as_of(end_ns), end_ns).at("topics"));
  EXPECT_EQ(topics.at(1).at("lost"), 6);
  EXPECT_EQ(topics.at(1).at("sent_late").at("count"), 5);
}

TEST_F(RecordedRunTest, ARigThatTheFileDoesNotHoldIsRefused) {
  record(session());
  FeedOptions other;
  other.rig = 2;
  EXPECT_THAT(support::refusal([&] { RecordedRun sut(file_, other, {}); }),
              AllOf(HasSubstr("--rig: got 2, of which"), HasSubstr("want one of 1")));
}

// Oracle: a recording that holds nothing else.
TEST_F(RecordedRunTest, AnyInstantIsThatOfARecordingWhichEndsThere) {
  const std::vector<Recorded> messages = session();
  record(messages);
  RecordedRun sut(file_, FeedOptions{}, {});
  for (const std::size_t last : {std::size_t{0}, std::size_t{1}, std::size_t{17}, std::size_t{9999},
                                 std::size_t{40'000}, std::size_t{71'234}, messages.size() - 1}) {
    const std::int64_t at_ns = messages[last].arrived_ns;
    std::vector<Recorded> heard;
    for (const Recorded& each : messages) {
      if (each.arrived_ns <= at_ns) heard.push_back(each);
    }
    std::filesystem::remove(cut_file_);
    record(heard, cut_file_);
    RecordedRun cut(cut_file_, FeedOptions{}, {});
    EXPECT_EQ(shown(sut.as_of(at_ns), at_ns), shown(cut.as_of(at_ns), at_ns)) << "message " << last;
  }
}

TEST_F(RecordedRunTest, MissesLossesAndEventsAreMarkedAtInstantsThatHoldThem) {
  record(session());
  RecordedRun sut(file_, FeedOptions{}, {});
  const auto lost = sut.timeline().marks(MarkKind::kLost);
  ASSERT_EQ(lost.size(), 6u);
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const auto topics = shown(sut.as_of(lost[i].at_ns), lost[i].at_ns).at("topics");
    EXPECT_EQ(topics.at(1).at("lost"), i + 1);
    const auto before = shown(sut.as_of(lost[i].at_ns - 1), lost[i].at_ns).at("topics");
    EXPECT_EQ(before.at(1).at("lost"), i);
    EXPECT_EQ(lost[i].subject, "stillhand/sensed");
  }
  EXPECT_EQ(sut.timeline().marks(MarkKind::kLate).size(), 5u);
  ASSERT_EQ(sut.timeline().marks(MarkKind::kEvent).size(), 1u);
  EXPECT_EQ(sut.timeline().marks(MarkKind::kEvent)[0].what, "liveliness lost");
  EXPECT_EQ(sut.timeline().marks(MarkKind::kEvent)[0].level, Level::kCritical);
  EXPECT_FALSE(sut.timeline().marks(MarkKind::kAlarm).empty());
  // What the page asks for holds the mark, too, though it counts in microseconds.
  const Json told = timeline_json(sut.timeline());
  const std::int64_t asked_ns = sut.instant_ns(told["marks"]["lost"][0]["at_s"].get<double>());
  EXPECT_GE(asked_ns, lost[0].at_ns);
  EXPECT_LT(asked_ns, lost[0].at_ns + 1000);
}

TEST_F(RecordedRunTest, ATrialSpansItsMeasuredTicks) {
  record(session());
  RecordedRun sut(file_, FeedOptions{}, {});
  ASSERT_EQ(sut.timeline().trials().size(), 1u);
  const TrialSpan& trial = sut.timeline().trials()[0];
  EXPECT_EQ(trial.number, 3);
  EXPECT_EQ(trial.phase, TrialPhase::kPegged);
  EXPECT_NEAR(static_cast<double>(trial.from_ns - kBegin), 5000.0 * kMs, 0.2 * kMs);
  EXPECT_NEAR(static_cast<double>(trial.to_ns - kBegin), 15'000.0 * kMs, 0.2 * kMs);
}

TEST_F(RecordedRunTest, AnInstantOutsideIsTheNearestInside) {
  record(session());
  RecordedRun sut(file_, FeedOptions{}, {});
  EXPECT_EQ(sut.instant_ns(-1e300), sut.timeline().begin_ns());
  EXPECT_EQ(sut.instant_ns(1e300), sut.timeline().end_ns());
}

TEST_F(RecordedRunTest, WhatIsNoRecordingIsRefused) {
  EXPECT_THROW(RecordedRun(file_, FeedOptions{}, {}), ConfigError);
}

}  // namespace stillhand::dashboard::recorded_run_test
