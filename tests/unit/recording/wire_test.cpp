// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/wire.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <string>

namespace stillhand::recording::wire_test {
namespace {

using testing::ElementsAreArray;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

// Expected bytes: the MCAP specification, "Serialization" (little-endian, 32-bit lengths).
TEST(WireTest, NumbersAndTextsHaveTheBytesOfTheMcapSpecification) {
  Bytes sut;
  put(sut, std::uint8_t{0xAB});
  put(sut, std::uint16_t{0x0102});
  put(sut, std::uint32_t{0x01020304});
  put(sut, std::uint64_t{0x0102030405060708});
  put_text(sut, "ab");
  put_text(sut, "");
  EXPECT_THAT(sut, ElementsAreArray(bytes_of({0xAB, 2, 1, 4, 3, 2, 1,   8,   7, 6, 5, 4, 3,
                                              2,    1, 2, 0, 0, 0, 'a', 'b', 0, 0, 0, 0})));
}

TEST(WireTest, AMapBeginsWithItsLengthInBytesAndIsSortedByKey) {
  Bytes sut;
  put_map(sut, {{"b", ""}, {"a", "1"}});
  EXPECT_THAT(sut, ElementsAreArray(bytes_of({19, 0,   0, 0, 1, 0, 0,   0, 'a', 1, 0, 0,
                                              0,  '1', 1, 0, 0, 0, 'b', 0, 0,   0, 0})));
}

TEST(WireTest, NumbersAtTheirLimitsReadBack) {
  Bytes bytes;
  put(bytes, std::numeric_limits<std::uint8_t>::max());
  put(bytes, std::numeric_limits<std::uint16_t>::max());
  put(bytes, std::numeric_limits<std::uint32_t>::max());
  put(bytes, std::numeric_limits<std::uint64_t>::max());
  WireReader sut(bytes);
  EXPECT_EQ(sut.take<std::uint8_t>(), 0xFFu);
  EXPECT_EQ(sut.take<std::uint16_t>(), 0xFFFFu);
  EXPECT_EQ(sut.take<std::uint32_t>(), 0xFFFF'FFFFu);
  EXPECT_EQ(sut.take<std::uint64_t>(), UINT64_MAX);
  EXPECT_TRUE(sut.ok());
  EXPECT_EQ(sut.left(), 0u);
}

TEST(WireTest, TextsAndMapsOfAnyBytesReadBack) {
  std::mt19937 random(11);
  const auto text = [&] {
    std::string made(random() % 40, '\0');
    for (char& c : made) c = static_cast<char>(random() % 256);
    return made;
  };
  for (int round = 0; round < 200; ++round) {
    TextMap map;
    for (auto i = random() % 6; i > 0; --i) map[text()] = text();
    const std::string alone = text();
    Bytes bytes;
    put_text(bytes, alone);
    put_map(bytes, map);
    WireReader sut(bytes);
    ASSERT_EQ(sut.take_text(), alone);
    ASSERT_EQ(sut.take_map(), map);
    ASSERT_TRUE(sut.ok());
    ASSERT_EQ(sut.left(), 0u);
  }
}

TEST(WireTest, AfterAFieldThatDoesNotFitEveryFieldIsEmpty) {
  Bytes bytes;
  put(bytes, std::uint32_t{9});  // length of a text that has 8 bytes
  put(bytes, std::uint64_t{0x1111111111111111});
  WireReader sut(bytes);
  EXPECT_EQ(sut.take_text(), "");
  EXPECT_FALSE(sut.ok());
  EXPECT_EQ(sut.left(), 0u);
  EXPECT_EQ(sut.take<std::uint8_t>(), 0u);
  EXPECT_TRUE(sut.take_bytes(0).empty());
  EXPECT_TRUE(sut.take_map().empty());
  EXPECT_FALSE(sut.ok());
}

TEST(WireTest, ALengthOfAlmostTwoToThe64IsRefused) {
  const Bytes bytes(16);
  WireReader sut(bytes);
  EXPECT_TRUE(sut.take_bytes(UINT64_MAX).empty());
  EXPECT_FALSE(sut.ok());
}

// The map's length ends inside its second text: the texts behind the map do not belong to it.
TEST(WireTest, AMapWhoseEntryCrossesItsEndIsRefused) {
  Bytes bytes;
  put_map(bytes, {{"key", "value"}});
  put_text(bytes, "behind the map");
  ASSERT_EQ(bytes[0], std::byte{16});  // 4 + "key" + 4 + "value"
  bytes[0] = std::byte{15};
  WireReader sut(bytes);
  EXPECT_TRUE(sut.take_map().empty());
  EXPECT_FALSE(sut.ok());
}

TEST(WireTest, RecordsAreTakenInOrderAndAPartOfARecordIsNone) {
  Bytes bytes;
  for (const auto& [opcode, text] :
       {std::pair{Opcode::kMetadata, "first"}, std::pair{Opcode::kDataEnd, ""}}) {
    const std::size_t mark = begin_record(bytes, opcode);
    put_bytes(bytes, std::as_bytes(std::span(std::string_view(text))));
    end_record(bytes, mark);
  }
  ASSERT_EQ(bytes.size(), 2 * kRecordHeadBytes + 5);
  std::span<const std::byte> sut(bytes);
  RecordView record{};
  ASSERT_TRUE(take_record(sut, record));
  EXPECT_EQ(record.opcode, Opcode::kMetadata);
  EXPECT_EQ(record.content.size(), 5u);
  EXPECT_EQ(record.content.data(), bytes.data() + kRecordHeadBytes);
  ASSERT_TRUE(take_record(sut, record));
  EXPECT_EQ(record.opcode, Opcode::kDataEnd);
  EXPECT_TRUE(record.content.empty());
  EXPECT_FALSE(take_record(sut, record));
  for (std::size_t length = 0; length < kRecordHeadBytes + 5; ++length) {
    std::span<const std::byte> cut(bytes.data(), length);
    EXPECT_FALSE(take_record(cut, record)) << length;
    EXPECT_EQ(cut.size(), length) << "the rest stays where it is";
  }
}

}  // namespace
}  // namespace stillhand::recording::wire_test
