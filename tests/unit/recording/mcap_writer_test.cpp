// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "places.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/recorded_file.hpp"

namespace stillhand::recording::mcap_writer_test {
namespace {

using tests::Bytes;

// The worked example of FORMAT.md: lines "<offset>  <bytes>  # <meaning>" between ```hex fences.
Bytes worked_example() {
  std::ifstream file(STILLHAND_SOURCE "/services/core/recording/FORMAT.md");
  Bytes bytes;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```hex";
      continue;
    }
    if (!inside) continue;
    std::istringstream words(line.substr(0, line.find('#')));
    std::size_t offset = 0;
    words >> std::hex >> offset;
    EXPECT_EQ(offset, bytes.size()) << "offset printed wrongly: " << line;
    for (unsigned value = 0; words >> std::hex >> value;) {
      bytes.push_back(static_cast<std::byte>(value));
    }
  }
  return bytes;
}

Bytes message_of(std::size_t count) { return Bytes(count, std::byte{0x5A}); }

TEST(McapWriterTest, WritesTheWorkedExampleOfTheFormatByteForByte) {
  MemorySink sink;
  McapWriter sut(sink, {1024, Compression::kNone});
  ASSERT_TRUE(sut.add_metadata("session", {{"seed", "1"}}).ok());
  const auto schema = sut.add_schema("P", kSchemaEncoding, "struct P { double x; };");
  const auto channel = sut.add_channel("p", schema, kMessageEncoding);
  const std::array<std::uint8_t, 12> cdr = {0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F};
  ASSERT_TRUE(sut.write(channel, 7, 1000, 900, std::as_bytes(std::span(cdr))).ok());
  ASSERT_TRUE(sut.close().ok());
  const Bytes expected = worked_example();
  ASSERT_FALSE(expected.empty()) << "FORMAT.md not found or without a hex block";
  EXPECT_EQ(sink.bytes(), expected);
}

TEST(McapWriterTest, WritesAChunkWhenItIsFullAndNotBefore) {
  MemorySink sink;
  McapWriter sut(sink, {1000, Compression::kNone});
  const auto channel = sut.add_channel("p", 0, "cdr");
  const std::uint64_t header = sink.size();
  ASSERT_TRUE(sut.write(channel, 0, 1, 1, message_of(400)).ok());
  EXPECT_EQ(sink.size(), header);
  ASSERT_TRUE(sut.write(channel, 1, 2, 2, message_of(600)).ok());
  EXPECT_GT(sink.size(), header + 1000);
  EXPECT_EQ(sut.statistics().chunk_count, 1u);
}

TEST(McapWriterTest, FlushChunkMakesEveryMessageRecoverableAndOfNothingWritesNothing) {
  MemorySink sink;
  McapWriter sut(sink, {1 << 20, Compression::kZstd});
  const std::uint64_t before = sink.size();
  EXPECT_TRUE(sut.flush_chunk().ok());
  EXPECT_EQ(sink.size(), before);
  const auto channel = sut.add_channel("p", 0, "cdr");
  ASSERT_TRUE(sut.write(channel, 0, 1, 1, message_of(10)).ok());
  ASSERT_TRUE(sut.flush_chunk().ok());
  ASSERT_TRUE(sut.write(channel, 1, 2, 2, message_of(10)).ok());
  MemorySource source(sink.bytes());
  McapReader reader(source);
  EXPECT_EQ(tests::messages_of(reader).size(), 1u);
}

TEST(McapWriterTest, AFullDiskIsAStatusThatStays) {
  for (std::uint64_t capacity = 0; capacity < 3000; capacity += 7) {
    MemorySink sink(capacity);
    McapWriter sut(sink, {300, Compression::kNone});
    const auto channel = sut.add_channel("p", 0, "cdr");
    Status status;
    for (std::uint32_t n = 0; n < 40 && status.ok(); ++n) {
      status = sut.write(channel, n, n, n, message_of(100));
    }
    ASSERT_EQ(status.kind, StatusKind::kNoSpace) << capacity;
    EXPECT_EQ(sut.write(channel, 0, 0, 0, message_of(1)).kind, StatusKind::kNoSpace);
    EXPECT_EQ(sut.add_metadata("m", {}).kind, StatusKind::kNoSpace);
    EXPECT_EQ(sut.close().kind, StatusKind::kNoSpace);
    EXPECT_EQ(sut.status().kind, StatusKind::kNoSpace);
    EXPECT_LE(sink.size(), capacity);
  }
}

TEST(McapWriterTest, RefusesToWriteAfterClose) {
  MemorySink sink;
  McapWriter sut(sink);
  const auto channel = sut.add_channel("p", 0, "cdr");
  ASSERT_TRUE(sut.close().ok());
  const std::uint64_t size = sink.size();
  EXPECT_EQ(sut.write(channel, 0, 0, 0, message_of(1)).kind, StatusKind::kClosed);
  EXPECT_EQ(sut.add_metadata("m", {}).kind, StatusKind::kClosed);
  EXPECT_EQ(sut.close().kind, StatusKind::kClosed);
  EXPECT_EQ(sink.size(), size);
}

TEST(McapWriterTest, RefusesAMessageTooLargeAndGoesOn) {
  MemorySink sink;
  McapWriter sut(sink);
  const auto channel = sut.add_channel("p", 0, "cdr");
  EXPECT_EQ(sut.write(channel, 0, 0, 0, message_of((64u << 20) + 1)).kind, StatusKind::kTooLarge);
  EXPECT_TRUE(sut.write(channel, 1, 1, 1, message_of(1)).ok());
  EXPECT_TRUE(sut.close().ok());
  EXPECT_EQ(sut.statistics().message_count, 1u);
}

TEST(McapWriterTest, EveryChunkNamesItsOwnChannels) {
  // So that one chunk can be read when all others are lost.
  const Bytes file = tests::recorded_file(40, Compression::kNone, 300);
  const std::string topic = "even";
  std::size_t found = 0;
  for (std::size_t i = 0; i + topic.size() < file.size(); ++i) {
    found += std::equal(topic.begin(), topic.end(), file.begin() + static_cast<std::ptrdiff_t>(i),
                        [](char c, std::byte b) { return static_cast<std::byte>(c) == b; });
  }
  MemorySource source(file);
  McapReader reader(source);
  ASSERT_GT(reader.statistics().chunk_count, 3u);
  EXPECT_EQ(found, reader.statistics().chunk_count + 1u) << "each chunk and the summary";
}

}  // namespace
}  // namespace stillhand::recording::mcap_writer_test
