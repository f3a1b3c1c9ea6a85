// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

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
  for (std::uint32_t n = 0; n < kCount; ++n) {  // also the first and the last of each chunk
    const std::uint64_t at_ns = plain_message(n).log_time_ns;
    ASSERT_EQ(messages_of(sut, {{}, at_ns, at_ns}), std::vector{plain_message(n)});
  }
}

TEST(McapReaderTest, StopsWhenTheCallerHasEnough) {
  const Bytes file = recorded_file(kCount, Compression::kNone, 2000);
  MemorySource source(file);
  McapReader sut(source);
  int count = 0;
  ASSERT_TRUE(sut.for_each_message({}, [&](const MessageView&) { return ++count < 3; }).ok());
  EXPECT_EQ(count, 3);
}

TEST(McapReaderTest, KeepsTopicsWithoutMessagesAndSchemasWithoutTopicsAndIsWholeWithoutAny) {
  MemorySink empty;
  ASSERT_TRUE(McapWriter(empty).close().ok());
  MemorySource nothing(empty.bytes());
  McapReader of_nothing(nothing);
  EXPECT_TRUE(of_nothing.verify().ok() && of_nothing.damage().empty());
  EXPECT_EQ(of_nothing.statistics().message_count, 0u);
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

// --- foreign files, put together by hand

// A file without an index around these records.
Bytes foreign(const std::function<void(Bytes&)>& put_records) {
  Bytes out;
  put_bytes(out, std::as_bytes(std::span(kMagic)));
  const auto header = begin_record(out, Opcode::kHeader);
  put_text(out, "ros2");
  put_text(out, "somebody else");
  end_record(out, header);
  put_records(out);
  const auto data_end = begin_record(out, Opcode::kDataEnd);
  put(out, std::uint32_t{0});
  end_record(out, data_end);
  const auto footer = begin_record(out, Opcode::kFooter);
  put(out, std::uint64_t{0});
  put(out, std::uint64_t{0});
  put(out, std::uint32_t{0});
  end_record(out, footer);
  put_bytes(out, std::as_bytes(std::span(kMagic)));
  return out;
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

void put_zeros(Bytes& out, std::size_t opcode, std::size_t length) {
  const auto mark = begin_record(out, static_cast<Opcode>(opcode));
  put_bytes(out, Bytes(length));
  end_record(out, mark);
}

TEST(McapReaderTest, ReadsAForeignFileWithoutChunksOrSummary) {
  const Bytes file = foreign([](Bytes& out) {
    put_schema(out, {7, "geometry_msgs/msg/Point", "ros2msg", {}});
    put_channel(out, {300, 7, "/point", "cdr", {}});
    put_message(out, 300, 0, 24);
    put_zeros(out, 0x09, 500);  // an attachment
    put_message(out, 300, 1, 0);
  });
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
    const Bytes file = foreign([spare](Bytes& out) {
      put_channel(out, {1, 0, "t", "json", {}});
      put_message(out, 1, 0, 4);
      const auto index = begin_record(out, Opcode::kAttachmentIndex);
      put_bytes(out, Bytes(40));
      put_text(out, "notes.txt");
      put_text(out, "text/plain");
      put_bytes(out, Bytes(spare));
      end_record(out, index);
    });
    MemorySource source(file);
    McapReader sut(source);
    ASSERT_TRUE(sut.status().ok());
    EXPECT_EQ(messages_of(sut).size(), 1u);
    EXPECT_EQ(sut.damage().size(), spare);
  }
}

TEST(McapReaderTest, IgnoresFieldsThatALaterVersionAppends) {
  const Bytes file = foreign([](Bytes& out) {
    Bytes channel;
    put_channel(channel, {1, 0, "t", "json", {}});
    put(channel, std::uint32_t{0xFFFF});
    end_record(channel, 1);
    put_bytes(out, channel);
    put_message(out, 1, 0, 4);
  });
  MemorySource source(file);
  McapReader sut(source);
  EXPECT_EQ(messages_of(sut).size(), 1u);
  EXPECT_TRUE(sut.damage().empty());
}

TEST(McapReaderTest, SaysThatARecordOfAnUnknownKindWasSkipped) {
  const Bytes file = foreign([](Bytes& out) {
    put_zeros(out, 0x90, 33);
    put_channel(out, {1, 0, "t", "json", {}});
    put_message(out, 1, 0, 4);
  });
  MemorySource source(file);
  McapReader sut(source);
  EXPECT_EQ(messages_of(sut).size(), 1u);
  ASSERT_EQ(sut.damage().size(), 1u);
  EXPECT_EQ(sut.damage()[0].kind, DamageKind::kUnknownRecord);
}

// The record behind one of an unknown kind proves its length, if it has the content that the fields
// of its kind take at least: numbers by their width, 4 bytes for the length of a text or map.
TEST(McapReaderTest, ARecordOfAnUnknownKindIsSkippedBeforeTheSmallestOfEveryKind) {
  // By opcode: none, Header, Footer, Schema, Channel, Message, Chunk, Message Index, Chunk Index,
  // Attachment, Attachment Index, Statistics, Metadata, Metadata Index, Summary Offset, Data End.
  constexpr std::size_t kLeast[] = {0,
                                    4 + 4,
                                    8 + 8 + 4,
                                    2 + 4 + 4 + 4,
                                    2 + 2 + 4 + 4 + 4,
                                    2 + 4 + 8 + 8,
                                    8 + 8 + 8 + 4 + 4 + 8,
                                    2 + 4,
                                    4 * 8 + 4 + 8 + 4 + 8 + 8,
                                    8 + 8 + 4 + 4 + 8 + 4,
                                    5 * 8 + 4 + 4,
                                    8 + 2 + 4 * 4 + 8 + 8 + 4,
                                    4 + 4,
                                    8 + 8 + 4,
                                    1 + 8 + 8,
                                    4};
  for (std::size_t opcode = 1; opcode < std::size(kLeast); ++opcode) {
    for (const std::size_t missing : {0u, 1u}) {
      const Bytes file = foreign([&](Bytes& out) {
        put_zeros(out, 0x90, 33);
        put_zeros(out, opcode, kLeast[opcode] - missing);
      });
      MemorySource source(file);
      const McapReader sut(source);
      EXPECT_EQ(std::ranges::count(sut.damage(), DamageKind::kUnknownRecord, &Damage::kind),
                missing == 0 ? 1 : 0)
          << opcode;
    }
  }
}

TEST(McapReaderTest, ReportsMessagesOfAnUndefinedChannel) {
  const Bytes file = foreign([](Bytes& out) { put_message(out, 5, 0, 100); });
  MemorySource source(file);
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
