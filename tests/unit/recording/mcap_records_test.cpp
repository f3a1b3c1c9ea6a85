// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_records.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

namespace stillhand::recording::mcap_records_test {
namespace {

// Content of the record that `put` writes, without its head.
Bytes content_of(const std::function<void(Bytes&)>& put, Opcode opcode) {
  Bytes bytes;
  put(bytes);
  std::span<const std::byte> records(bytes);
  RecordView record{};
  EXPECT_TRUE(take_record(records, record));
  EXPECT_TRUE(records.empty()) << "one record";
  EXPECT_EQ(record.opcode, opcode);
  return {record.content.begin(), record.content.end()};
}

Bytes with_tail(Bytes content, std::size_t count) {
  content.insert(content.end(), count, std::byte{0xEE});
  return content;
}

Bytes some_bytes(std::size_t count) {
  Bytes bytes;
  for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(i * 37));
  return bytes;
}

// Parses `content`, all of its prefixes and the content of a later version.
template <typename Record, typename Parse>
void expect_strict(const Bytes& content, const Record& want, Parse parse) {
  const auto whole = parse(content);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->record, want);
  EXPECT_EQ(whole->extra_bytes, 0u);
  for (std::size_t length = 0; length < content.size(); ++length) {
    EXPECT_FALSE(parse(std::span(content).first(length)).has_value()) << length;
  }
  const auto later = parse(with_tail(content, 7));
  ASSERT_TRUE(later.has_value());
  EXPECT_EQ(later->record, want);
  EXPECT_EQ(later->extra_bytes, 7u);
}

TEST(McapRecordsTest, DefinitionsAndMetadataReadBackAndEveryPrefixOfThemIsRefused) {
  const Schema schema{65535, "a::B", "omgidl", some_bytes(300)};
  expect_strict(content_of([&](Bytes& out) { put_schema(out, schema); }, Opcode::kSchema), schema,
                parse_schema);
  const Channel channel{7, 65535, "stillhand/sensed", "cdr", {{"writer", "1.f"}, {"", ""}}};
  expect_strict(content_of([&](Bytes& out) { put_channel(out, channel); }, Opcode::kChannel),
                channel, parse_channel);
  const Metadata metadata{"stillhand.session", {{"seed", "1"}, {"host", std::string(500, 'h')}}};
  expect_strict(content_of([&](Bytes& out) { put_metadata(out, metadata.name, metadata.texts); },
                           Opcode::kMetadata),
                metadata, parse_metadata);
}

TEST(McapRecordsTest, StatisticsAndAChunkIndexReadBackAndEveryPrefixOfThemIsRefused) {
  const Statistics statistics{
      UINT64_MAX, 65535, 1, 2, 3, UINT32_MAX, 4, UINT64_MAX, {{0, 1}, {65535, UINT64_MAX}}};
  const Bytes counts =
      content_of([&](Bytes& out) { put_statistics(out, statistics); }, Opcode::kStatistics);
  EXPECT_EQ(counts.size(), 46u + 2 * 10u);  // FORMAT.md: 8+2+4*4+2*8, map length 4, 10 an entry
  EXPECT_EQ(parse_statistics(counts), statistics);
  EXPECT_EQ(parse_statistics(with_tail(counts, 3)), statistics);
  const auto bytes_of = [](const ChunkIndex& index) {
    return content_of([&](Bytes& out) { put_chunk_index(out, index); }, Opcode::kChunkIndex);
  };
  const Bytes place = bytes_of({1, UINT64_MAX, 3, 4, {{2, 5}, {9, 6}}, 7, "zstd", 8, 9});
  EXPECT_EQ(place.size(), 64u + 2 * 10u + 4u);  // 4*8, map length 4, 8, text length 4, 2*8
  EXPECT_EQ(bytes_of(parse_chunk_index(place).value()), place);
  EXPECT_EQ(parse_chunk_index(place)->uncompressed_size, 9u);
  for (std::size_t length = 0; length < counts.size(); ++length) {
    EXPECT_FALSE(parse_statistics(std::span(counts).first(length)).has_value()) << length;
  }
  for (std::size_t length = 0; length < place.size(); ++length) {
    EXPECT_FALSE(parse_chunk_index(std::span(place).first(length)).has_value()) << length;
  }
}

// Fields of a chunk before its packed records, as FORMAT.md lists them.
Bytes chunk_head(const std::string& compression, std::uint64_t packed_size) {
  Bytes bytes;
  put(bytes, std::uint64_t{10});
  put(bytes, std::uint64_t{20});
  put(bytes, std::uint64_t{300});
  put(bytes, std::uint32_t{0xCAFE});
  put_text(bytes, compression);
  put(bytes, packed_size);
  return bytes;
}

TEST(McapRecordsTest, AChunkHeadReadsBackAndStatesTheLengthOfItsContent) {
  const Bytes prefix = chunk_head("lz4", 100);
  const auto sut = parse_chunk_head(prefix, prefix.size() + 100);
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->start_time_ns, 10u);
  EXPECT_EQ(sut->end_time_ns, 20u);
  EXPECT_EQ(sut->uncompressed_size, 300u);
  EXPECT_EQ(sut->uncompressed_crc, 0xCAFEu);
  EXPECT_EQ(sut->compression, "lz4");
  EXPECT_EQ(sut->packed_size, 100u);
  EXPECT_EQ(sut->content_bytes(), prefix.size() + 100);
}

TEST(McapRecordsTest, PackedRecordsThatEndBehindTheirChunkAreRefused) {
  const Bytes prefix = chunk_head("zstd", 100);
  EXPECT_TRUE(parse_chunk_head(prefix, prefix.size() + 100).has_value());
  EXPECT_FALSE(parse_chunk_head(prefix, prefix.size() + 99).has_value());
  EXPECT_FALSE(parse_chunk_head(prefix, prefix.size() - 1).has_value());
  EXPECT_FALSE(parse_chunk_head(chunk_head("", UINT64_MAX), UINT64_MAX).has_value());
  EXPECT_FALSE(parse_chunk_head(chunk_head("", UINT64_MAX - 20), 1000).has_value());
  for (std::size_t length = 0; length < prefix.size(); ++length) {
    EXPECT_FALSE(parse_chunk_head(std::span(prefix).first(length), 10'000).has_value()) << length;
  }
}

TEST(McapRecordsTest, AFooterIsReadOnlyIfOpcodeLengthAndMagicAreRight) {
  Bytes tail;
  const std::size_t mark = begin_record(tail, Opcode::kFooter);
  put(tail, std::uint64_t{111});
  put(tail, std::uint64_t{222});
  put(tail, std::uint32_t{333});
  end_record(tail, mark);
  put_bytes(tail, std::as_bytes(std::span(kMagic)));
  ASSERT_EQ(tail.size(), kFooterAndMagicBytes);
  const auto sut = parse_footer_and_magic(tail);
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->summary_start, 111u);
  EXPECT_EQ(sut->summary_offset_start, 222u);
  EXPECT_EQ(sut->summary_crc, 333u);
  constexpr std::size_t kFields = 20;  // any value of these bytes is a footer
  for (std::size_t at = 0; at < tail.size(); ++at) {
    Bytes other = tail;
    other[at] ^= std::byte{1};
    const bool field = at >= kRecordHeadBytes && at < kRecordHeadBytes + kFields;
    EXPECT_EQ(parse_footer_and_magic(other).has_value(), field) << at;
  }
  EXPECT_FALSE(parse_footer_and_magic(std::span(tail).first(tail.size() - 1)).has_value());
}

// Length fields decide how far a parser reads: it must stay inside for every value of them.
TEST(McapRecordsTest, RandomBytesGiveARecordOrNothing) {
  std::mt19937 random(3);
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes(random() % 80);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 4 == 0 ? random() : 0);
    if (const auto schema = parse_schema(bytes)) {
      ASSERT_LE(schema->extra_bytes + schema->record.bytes.size() + 14, bytes.size());
    }
    if (const auto channel = parse_channel(bytes)) {
      ASSERT_LE(channel->record.topic.size() + 16, bytes.size());
    }
    if (const auto metadata = parse_metadata(bytes)) {
      ASSERT_LE(metadata->record.name.size() + 8, bytes.size());
    }
    if (const auto head = parse_chunk_head(bytes, bytes.size())) {
      ASSERT_LE(head->content_bytes(), bytes.size());
    }
    (void)parse_chunk_index(bytes);
    (void)parse_statistics(bytes);
  }
}

}  // namespace
}  // namespace stillhand::recording::mcap_records_test
