// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/info.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "services/core/recording/mcap/mcap_loss.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::info_test {
namespace {

using testing::HasSubstr;

class InfoTest : public FolderTest {};

TEST_F(InfoTest, TopicsCountsRatesAndLostTicksAreFound) {
  write_sample(path("a.mcap"));
  OpenRecording recording(path("a.mcap"));
  const RecordingInfo sut = info_of(recording);
  EXPECT_TRUE(sut.whole);
  EXPECT_EQ(sut.messages, 204u);
  EXPECT_EQ(sut.start_ns, kSampleStart_ns);
  EXPECT_EQ(sut.end_ns, kSampleStart_ns + 199'000'000u);
  EXPECT_THAT(sut.packings, testing::ElementsAre("zstd"));
  ASSERT_EQ(sut.topics.size(), 2u);
  const TopicInfo& sensed = sut.topics[1];
  EXPECT_EQ(sensed.topic, "stillhand/sensed");
  EXPECT_EQ(sensed.type, "stillhand_msgs::Sensed");
  EXPECT_EQ(sensed.messages, 200u);
  EXPECT_NEAR(sensed.rate_hz, 1000.0, 1e-6);  // 199 steps of 1 ms exactly; the rest is rounding
  EXPECT_EQ(sensed.lost_ticks, 2);
  ASSERT_EQ(sensed.channels.size(), 1u);
  EXPECT_EQ(sensed.channels[0].at("qos_profile"), "stream_1khz");
  EXPECT_EQ(sut.topics[0].lost_ticks, std::nullopt) << "an event's tick counts nothing";
}

// Each writer of a topic has a channel of its own, and ticks of its own.
TEST_F(InfoTest, TheWritersOfATopicAreOneTopic) {
  write_two_writers(path("a.mcap"));
  OpenRecording recording(path("a.mcap"));
  const RecordingInfo sut = info_of(recording);
  ASSERT_EQ(sut.topics.size(), 1u);
  EXPECT_EQ(sut.topics[0].messages, 6u);
  EXPECT_EQ(sut.topics[0].lost_ticks, 2);
  ASSERT_EQ(sut.topics[0].channels.size(), 2u);
  EXPECT_EQ(sut.topics[0].channels[1].at("writer"), "second");
}

TEST_F(InfoTest, TextAndJsonSayTheSame) {
  write_sample(path("a.mcap"));
  OpenRecording recording(path("a.mcap"));
  const RecordingInfo info = info_of(recording);
  const std::string text = info_text(info);
  for (const char* words : {"whole", "204 messages", "stillhand/sensed", "1000", "seed: 7"}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
  const auto json = nlohmann::json::parse(info_json(info));
  EXPECT_EQ(json["messages"], 204);
  EXPECT_EQ(json["topics"][1]["lost_ticks"], 2);
  EXPECT_TRUE(json["topics"][0]["lost_ticks"].is_null());
  EXPECT_EQ(json["metadata"][0]["texts"]["seed"], "7");
  EXPECT_EQ(json["whole"], true);
}

TEST_F(InfoTest, AFileThatACrashLeftOpenIsReadAndSaidToBe) {
  write_sample(path("a.mcap"), false);
  std::filesystem::resize_file(path("a.mcap"), std::filesystem::file_size(path("a.mcap")) - 600);
  OpenRecording recording(path("a.mcap"));
  const RecordingInfo sut = info_of(recording);
  EXPECT_FALSE(sut.whole);
  EXPECT_GT(sut.messages, 150u);
  EXPECT_LT(sut.messages, 204u);
  EXPECT_GT(sut.lost_bytes, 0u);
  const std::string line = recording::loss_line("a.mcap", recording.reader, sut.messages, false);
  EXPECT_THAT(line, HasSubstr("a.mcap: cut off, as after a crash; "));
  EXPECT_THAT(line, HasSubstr(" lost at its end, " + std::to_string(sut.messages) + " messages"));
}

TEST_F(InfoTest, AFileThatGrowsWhileItIsReadIsReadAsItWasAndSaidToGrow) {
  recording::FileSink sink(path("a.mcap"));
  recording::McapWriter writer(sink);
  const auto channel = writer.add_channel("p", 0, "cdr");
  const std::vector<std::byte> bytes(100);
  ASSERT_TRUE(writer.write(channel, 0, 1, 1, bytes).ok());
  ASSERT_TRUE(writer.flush_chunk().ok());
  OpenRecording recording(path("a.mcap"));
  ASSERT_TRUE(writer.write(channel, 1, 2, 2, bytes).ok());
  ASSERT_TRUE(writer.close().ok());
  const RecordingInfo sut = info_of(recording);
  EXPECT_EQ(sut.messages, 1u);
  EXPECT_TRUE(sut.being_written);
  EXPECT_THAT(info_text(sut), HasSubstr("still being written"));
  EXPECT_THAT(recording::loss_line("a", recording.reader, 1, true), HasSubstr("still being"));
}

TEST_F(InfoTest, WhatIsNoRecordingIsRefusedInWords) {
  const auto refused = [&](const std::string& bytes) {
    EXPECT_TRUE(recording::write_file_atomically(path("x"), bytes).ok());
    return support::refusal([&] { OpenRecording recording(path("x")); });
  };
  EXPECT_THAT(refused(""), HasSubstr("x: got not an MCAP file"));
  EXPECT_THAT(refused("t [s],f [N]\n0,1\n"), HasSubstr("want a recording (MCAP, version 0)"));
  EXPECT_THAT(refused(std::string(1 << 20, '\x06')), HasSubstr("not an MCAP file"));
  // A newer version, whole and cut off.
  const std::string newer = "\x89MCAP1\r\n";
  EXPECT_THAT(refused(newer + "something new" + newer), HasSubstr("got an MCAP file of version 1"));
  EXPECT_THAT(refused(newer + "something new"), HasSubstr("got an MCAP file of version 1"));
  EXPECT_THAT(support::refusal([&] { OpenRecording recording(path("nowhere")); }),
              HasSubstr("nowhere: got No such file"));
  EXPECT_THAT(support::refusal([&] { OpenRecording recording(folder_.path().string()); }),
              HasSubstr("not a regular file"));
}

// The header by itself: with its index the file is read without it.
TEST_F(InfoTest, ADamagedHeaderIsSaid) {
  write_sample(path("a.mcap"));
  const std::string bytes = recording::read_file(path("a.mcap"));
  // Behind the magic: opcode, length (8 bytes), length of the profile's text (4), its text.
  for (const std::size_t at : {8u, 9u, 17u, 22u}) {
    std::string broken = bytes;
    broken[at] = static_cast<char>(broken[at] ^ 0x40);
    ASSERT_TRUE(recording::write_file_atomically(path("b.mcap"), broken).ok());
    OpenRecording recording(path("b.mcap"));
    const RecordingInfo sut = info_of(recording);
    EXPECT_FALSE(sut.whole) << at;
    EXPECT_EQ(sut.messages, 204u) << at;
    EXPECT_THAT(info_text(sut), HasSubstr("damaged, but nothing is lost")) << at;
    const bool text_alone = at == 22u;  // still a header, of another profile: the checksum tells
    EXPECT_EQ(sut.damage.front().offset, text_alone ? 0u : 8u) << at;
    EXPECT_EQ(sut.program, text_alone ? "stillhand" : "") << at;
  }
}

// A record that says 4 GiB, in a file of a few kB: refused by its number, nothing allocated.
TEST_F(InfoTest, ALengthFieldOf4GiBIsRefusedAndTheRestIsRead) {
  write_sample(path("a.mcap"));
  std::string bytes = recording::read_file(path("a.mcap"));
  const std::string length("\x00\x00\x00\x00\x01\x00\x00\x00", 8);
  // The Header and a Metadata record come first (FORMAT.md); the first chunk stands behind them.
  std::size_t chunk = 8;
  while (bytes[chunk] != 6) {
    std::uint64_t skip = 0;
    std::memcpy(&skip, bytes.data() + chunk + 1, sizeof(skip));
    chunk += 9 + static_cast<std::size_t>(skip);
  }
  for (const std::size_t at : {chunk + 1, chunk + 9 + 16, chunk + 9 + 28 + 8}) {
    std::string broken = bytes;
    broken.replace(at, 8, length);
    ASSERT_TRUE(recording::write_file_atomically(path("b.mcap"), broken).ok());
    OpenRecording recording(path("b.mcap"));
    const RecordingInfo sut = info_of(recording);
    EXPECT_FALSE(sut.whole) << at;
    EXPECT_GT(sut.messages, 180u) << at;
  }
}

TEST_F(InfoTest, AFileThatMayNotBeReadIsRefusedWithTheSystemsReason) {
  write_sample(path("a.mcap"));
  std::filesystem::permissions(path("a.mcap"), std::filesystem::perms::none);
  // Root may read everything; nobody may not.
  constexpr uid_t kNobody = 65534;
  const bool root = geteuid() == 0;
  if (root) {
    std::filesystem::permissions(folder_, std::filesystem::perms::all);
    ASSERT_EQ(seteuid(kNobody), 0);
  }
  const std::string error = support::refusal([&] { OpenRecording recording(path("a.mcap")); });
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  EXPECT_THAT(error, HasSubstr("a.mcap: got Permission denied, want a file that can be read"));
}

}  // namespace
}  // namespace stillhand::recordings::info_test
