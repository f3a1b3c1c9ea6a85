// SPDX-License-Identifier: Apache-2.0
// The page's counts of a bus are those of its recording: one sequence of messages by both ways.
#include "dashboard/recorded_run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "contract/config_error.hpp"
#include "dashboard/snapshot_json.hpp"
#include "recording/core/mcap_writer.hpp"
#include "recording/file_io.hpp"

namespace stillhand::dashboard {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kBegin = 1'700'000'000'000 * kMs;

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

class RecordedRunTest : public ::testing::Test {
 protected:
  ~RecordedRunTest() override { std::filesystem::remove(file_); }

  std::string file_ = testing::TempDir() + "stillhand_run_" + std::to_string(getpid()) + ".mcap";
};

TEST_F(RecordedRunTest, CountsAreThoseOfTheBusToTheLastDigit) {
  MessageFeed live{FeedOptions{}}, replayed{FeedOptions{}};
  const Source source{"stillhand/sensed", "stillhand_msgs::Sensed", "stillhand/1/sensing", false};
  const std::uint32_t number = live.add(source);
  {
    recording::FileSink sink(file_);
    recording::McapWriter writer(sink, {100'000, recording::Compression::kZstd, "stillhand-test"});
    const auto schema = writer.add_schema(source.type, "omgidl", "");
    const auto channel =
        writer.add_channel(source.topic, schema, "cdr", {{"participant", source.participant}});
    for (Tick tick = 0; tick < 5000; ++tick) {
      if (tick % 700 == 3) continue;                              // lost
      const std::int64_t late = tick % 900 == 7 ? 4'321'987 : 0;  // sent late
      const std::int64_t sent = kBegin + tick * kMs + late;
      const std::int64_t arrived = sent + 90'000 + (tick * 7919) % 50'000;
      const auto bytes = head(tick, tick * kMs + late);
      live.take({number, static_cast<std::uint32_t>(tick), sent, arrived, bytes});
      ASSERT_TRUE(writer
                      .write(channel, static_cast<std::uint32_t>(tick),
                             static_cast<std::uint64_t>(arrived), static_cast<std::uint64_t>(sent),
                             bytes)
                      .ok());
    }
    ASSERT_TRUE(writer.close().ok());
  }
  const std::int64_t now = feed_recording(file_, replayed, {});
  const auto topics = [now](const MessageFeed& feed) {
    return nlohmann::json::parse(snapshot_json(feed, {}, now, -1)).at("topics");
  };
  EXPECT_EQ(topics(live), topics(replayed));
  EXPECT_EQ(topics(live).at(1).at("lost"), 8);
  EXPECT_EQ(topics(live).at(1).at("sent_late").at("count"), 6);
}

TEST_F(RecordedRunTest, WhatIsNoRecordingIsRefused) {
  MessageFeed sut{FeedOptions{}};
  EXPECT_THROW(feed_recording(file_, sut, {}), ConfigError);
}

}  // namespace
}  // namespace stillhand::dashboard
