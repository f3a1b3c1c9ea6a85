// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/recording/mcap/mcap_records.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/recorded_file.hpp"

namespace stillhand::recording::mcap_reader_test {
namespace {

using tests::messages_of;
using tests::plain_message;
using tests::PlainMessage;
using tests::recorded_file;

constexpr std::uint32_t kCount = 200;

std::vector<PlainMessage> all_messages() {
  std::vector<PlainMessage> messages;
  for (std::uint32_t n = 0; n < kCount; ++n) messages.push_back(plain_message(n));
  return messages;
}

class McapRoundTripTest : public testing::TestWithParam<Compression> {};

TEST_P(McapRoundTripTest, GivesBackEveryMessageAndDefinition) {
  const Bytes file = recorded_file(kCount, GetParam(), 2000);
  MemorySource source(file);
  McapReader sut(source);
  ASSERT_TRUE(sut.status().ok()) << sut.status().text;
  EXPECT_TRUE(sut.indexed());
  EXPECT_EQ(messages_of(sut), all_messages());
  EXPECT_EQ(sut.profile(), kProfile);
  EXPECT_EQ(sut.library(), "stillhand-test");
  ASSERT_EQ(sut.channels().size(), 2u);
  const Channel expected{0, 1, "even", "cdr", {{"qos", "stream_1khz"}}};
  EXPECT_EQ(sut.channels().at(0), expected);
  ASSERT_EQ(sut.schemas().size(), 1u);
  EXPECT_EQ(sut.schemas().at(1).encoding, "omgidl");
  ASSERT_NE(sut.find_metadata("session"), nullptr);
  EXPECT_EQ(sut.find_metadata("session")->texts.at("subject"), "S03");
  EXPECT_NE(sut.find_metadata("result"), nullptr);
  EXPECT_EQ(sut.find_metadata("nothing"), nullptr);
}

TEST_P(McapRoundTripTest, AWholeFileHasNoDamage) {
  const Bytes file = recorded_file(kCount, GetParam(), 2000);
  MemorySource source(file);
  McapReader sut(source);
  ASSERT_TRUE(sut.verify().ok());
  EXPECT_TRUE(sut.damage().empty()) << sut.damage().front().text;
}

TEST_P(McapRoundTripTest, TheScanFindsWhatTheIndexTells) {
  const Bytes file = recorded_file(kCount, GetParam(), 2000);
  MemorySource source(file);
  McapReader by_index(source);
  const Bytes without_end(file.begin(), file.end() - 1);
  MemorySource cut_source(without_end);
  McapReader sut(cut_source);
  EXPECT_FALSE(sut.indexed());
  EXPECT_EQ(sut.statistics(), by_index.statistics());
  EXPECT_EQ(sut.channels(), by_index.channels());
  EXPECT_EQ(sut.schemas(), by_index.schemas());
  EXPECT_EQ(sut.metadata(), by_index.metadata());
  EXPECT_EQ(messages_of(sut), all_messages());
  EXPECT_EQ(sut.lost_bytes(), 0u);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, McapRoundTripTest,
                         testing::Values(Compression::kNone, Compression::kLz4,
                                         Compression::kZstd));

TEST(McapReaderTest, CountsPerChannelAndTime) {
  const Bytes file = recorded_file(kCount, Compression::kZstd, 2000);
  MemorySource source(file);
  McapReader sut(source);
  EXPECT_EQ(sut.statistics().message_count, kCount);
  EXPECT_EQ(sut.statistics().channel_message_counts.at(0), kCount / 2);
  EXPECT_EQ(sut.statistics().start_time_ns, plain_message(0).log_time_ns);
  EXPECT_EQ(sut.statistics().end_time_ns, plain_message(kCount - 1).log_time_ns);
  EXPECT_EQ(sut.statistics().metadata_count, 2u);
}

TEST(McapReaderTest, FiltersByTopicAndTime) {
  const Bytes file = recorded_file(kCount, Compression::kLz4, 2000);
  MemorySource source(file);
  McapReader sut(source);
  const MessageFilter filter{
      {"odd"}, plain_message(50).log_time_ns, plain_message(101).log_time_ns};
  const auto messages = messages_of(sut, filter);
  ASSERT_EQ(messages.size(), 26u);  // 51, 53, ... 101
  EXPECT_EQ(messages.front(), plain_message(51));
  EXPECT_EQ(messages.back(), plain_message(101));
}

TEST(McapReaderTest, StopsWhenTheCallerHasEnough) {
  const Bytes file = recorded_file(kCount, Compression::kNone, 2000);
  MemorySource source(file);
  McapReader sut(source);
  int count = 0;
  ASSERT_TRUE(sut.for_each_message({}, [&](const MessageView&) { return ++count < 3; }).ok());
  EXPECT_EQ(count, 3);
}

TEST(McapReaderTest, KeepsTopicsWithoutMessagesAndSchemasWithoutTopics) {
  MemorySink sink;
  McapWriter writer(sink);
  writer.add_schema("Unused", "omgidl", "struct Unused {};");
  writer.add_channel("silent", 0, "cdr");
  ASSERT_TRUE(writer.close().ok());
  for (const std::size_t cut : {0u, 1u}) {  // by index and by scan
    const Bytes file(sink.bytes().begin(), sink.bytes().end() - static_cast<std::ptrdiff_t>(cut));
    MemorySource source(file);
    McapReader sut(source);
    ASSERT_EQ(sut.channels().size(), 1u);
    EXPECT_EQ(sut.channels().at(0).topic, "silent");
    EXPECT_EQ(sut.schemas().size(), 1u);
    EXPECT_TRUE(messages_of(sut).empty());
  }
}

TEST(McapReaderTest, AnEmptyRecordingIsWhole) {
  MemorySink sink;
  McapWriter writer(sink);
  ASSERT_TRUE(writer.close().ok());
  MemorySource source(sink.bytes());
  McapReader sut(source);
  ASSERT_TRUE(sut.status().ok());
  EXPECT_TRUE(sut.verify().ok());
  EXPECT_TRUE(sut.damage().empty());
  EXPECT_EQ(sut.statistics().message_count, 0u);
}

// --- foreign files, put together by hand

void put_header(Bytes& out) {
  put_bytes(out, std::as_bytes(std::span(kMagic)));
  const auto mark = begin_record(out, Opcode::kHeader);
  put_text(out, "ros2");
  put_text(out, "somebody else");
  end_record(out, mark);
}

void put_message(Bytes& out, ChannelId channel, std::uint32_t sequence, std::size_t length) {
  const auto mark = begin_record(out, Opcode::kMessage);
  put(out, channel);
  put(out, sequence);
  put(out, std::uint64_t{sequence} + 10);
  put(out, std::uint64_t{sequence} + 5);
  put_bytes(out, Bytes(length, std::byte{3}));
  end_record(out, mark);
}

void put_end(Bytes& out) {
  const auto data_end = begin_record(out, Opcode::kDataEnd);
  put(out, std::uint32_t{0});
  end_record(out, data_end);
  const auto footer = begin_record(out, Opcode::kFooter);
  put(out, std::uint64_t{0});
  put(out, std::uint64_t{0});
  put(out, std::uint32_t{0});
  end_record(out, footer);
  put_bytes(out, std::as_bytes(std::span(kMagic)));
}

Bytes unchunked_file() {
  Bytes out;
  put_header(out);
  put_schema(out, {7, "geometry_msgs/msg/Point", "ros2msg", {}});
  put_channel(out, {300, 7, "/point", "cdr", {}});
  put_message(out, 300, 0, 24);
  const auto attachment = begin_record(out, Opcode::kAttachment);
  put_bytes(out, Bytes(500));
  end_record(out, attachment);
  put_message(out, 300, 1, 0);
  put_end(out);
  return out;
}

TEST(McapReaderTest, ReadsAForeignFileWithoutChunksOrSummary) {
  const Bytes file = unchunked_file();
  MemorySource source(file);
  McapReader sut(source);
  ASSERT_TRUE(sut.status().ok());
  EXPECT_EQ(sut.profile(), "ros2");
  EXPECT_EQ(sut.channels().at(300).topic, "/point");
  const auto messages = messages_of(sut);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].bytes.size(), 24u);
  EXPECT_TRUE(messages[1].bytes.empty());
  EXPECT_EQ(sut.statistics().attachment_count, 1u);
  EXPECT_TRUE(sut.damage().empty()) << sut.damage().front().text;
}

// A summary's index of attachments is known; a byte behind its texts is damage.
TEST(McapReaderTest, AnIndexOfAttachmentsIsPartOfASummary) {
  for (const std::size_t spare : {0u, 1u}) {
    Bytes file;
    put_header(file);
    put_channel(file, {1, 0, "t", "json", {}});
    put_message(file, 1, 0, 4);
    const auto index = begin_record(file, Opcode::kAttachmentIndex);
    put_bytes(file, Bytes(40));
    put_text(file, "notes.txt");
    put_text(file, "text/plain");
    put_bytes(file, Bytes(spare));
    end_record(file, index);
    put_end(file);
    MemorySource source(file);
    McapReader sut(source);
    ASSERT_TRUE(sut.status().ok());
    EXPECT_EQ(messages_of(sut).size(), 1u);
    EXPECT_EQ(sut.damage().size(), spare);
  }
}

TEST(McapReaderTest, IgnoresFieldsThatALaterVersionAppends) {
  Bytes out;
  put_header(out);
  Bytes channel;
  put_channel(channel, {1, 0, "t", "json", {}});
  put(channel, std::uint32_t{0xFFFF});
  end_record(channel, 1);
  put_bytes(out, channel);
  put_message(out, 1, 0, 4);
  put_end(out);
  MemorySource source(out);
  McapReader sut(source);
  EXPECT_EQ(messages_of(sut).size(), 1u);
  EXPECT_TRUE(sut.damage().empty());
}

TEST(McapReaderTest, SaysThatARecordOfAnUnknownKindWasSkipped) {
  Bytes out;
  put_header(out);
  const auto mark = begin_record(out, static_cast<Opcode>(0x90));
  put_bytes(out, Bytes(33));
  end_record(out, mark);
  put_channel(out, {1, 0, "t", "json", {}});
  put_message(out, 1, 0, 4);
  put_end(out);
  MemorySource source(out);
  McapReader sut(source);
  EXPECT_EQ(messages_of(sut).size(), 1u);
  ASSERT_EQ(sut.damage().size(), 1u);
  EXPECT_EQ(sut.damage()[0].kind, DamageKind::kUnknownRecord);
}

TEST(McapReaderTest, ReportsMessagesOfAnUndefinedChannel) {
  Bytes out;
  put_header(out);
  put_message(out, 5, 0, 100);
  put_end(out);
  MemorySource source(out);
  McapReader sut(source);
  EXPECT_TRUE(messages_of(sut).empty());
  ASSERT_EQ(sut.damage().size(), 1u);
  EXPECT_EQ(sut.damage()[0].kind, DamageKind::kUnknownChannel);
  EXPECT_EQ(sut.lost_bytes(), 9u + 22u + 100u);
}

TEST(McapReaderTest, VerifyGivesTheMessagesThatItReads) {
  const Bytes file = tests::recorded_file(10, Compression::kNone, 400);
  MemorySource source(file);
  McapReader sut(source);
  std::vector<std::uint32_t> sequences;
  ASSERT_TRUE(
      sut.verify([&](const MessageView& message) { sequences.push_back(message.sequence); }).ok());
  EXPECT_EQ(sequences, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(McapReaderTest, RefusesWhatIsNoMcapFile) {
  for (const std::string text : {"", "x", "t [s],f [N]\n0,1\n", "\x89MCAP1\r\n"}) {
    MemorySource source(std::as_bytes(std::span(text)));
    McapReader sut(source);
    EXPECT_EQ(sut.status().kind, StatusKind::kDamaged) << text;
    EXPECT_FALSE(sut.for_each_message({}, [](const MessageView&) { return true; }).ok());
  }
}

TEST(McapReaderTest, AFailingSourceIsAStatus) {
  class Failing : public MemorySource {
   public:
    Failing(std::span<const std::byte> bytes, int good_reads)
        : MemorySource(bytes), good_reads_(good_reads) {}
    Status read_at(std::uint64_t offset, std::span<std::byte> into) override {
      if (good_reads_-- <= 0) return Status::failure(StatusKind::kIo, "disk gone");
      return MemorySource::read_at(offset, into);
    }

   private:
    int good_reads_;
  };
  const Bytes file = recorded_file(kCount, Compression::kNone, 2000);
  for (int good_reads = 0; good_reads < 7; ++good_reads) {  // opening and walking take 7
    Failing source(file, good_reads);
    McapReader sut(source);
    const Status walked = sut.for_each_message({}, [](const MessageView&) { return true; });
    EXPECT_EQ(walked.kind, StatusKind::kIo) << good_reads;
  }
}

}  // namespace
}  // namespace stillhand::recording::mcap_reader_test
