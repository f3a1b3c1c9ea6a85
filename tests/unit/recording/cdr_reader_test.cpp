// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/cdr_reader.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <random>
#include <vector>

namespace stillhand::recording::cdr_reader_test {
namespace {

std::vector<std::byte> message(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

// OMG DDS-XTypes 1.3, 7.4.1: plain CDR aligns a value to its size.
TEST(CdrReaderTest, PlainCdrAlignsEachValueToItsSize) {
  const auto bytes = message({0, 1,  0,    0,                           // little-endian plain CDR
                              7, 99, 0x34, 0x12,                        // octet, padding, short
                              1, 0,  0,    0,                           // long
                              5, 99, 99,   99,   99, 99, 99,   99,      // octet, padding up to 16
                              0, 0,  0,    0,    0,  0,  0xF0, 0x3F});  // double 1.0
  CdrReader sut(bytes);
  EXPECT_FALSE(sut.second_edition());
  EXPECT_EQ(sut.take<std::uint8_t>(), 7u);
  EXPECT_EQ(sut.take<std::int16_t>(), 0x1234);
  EXPECT_EQ(sut.take<std::int32_t>(), 1);
  EXPECT_EQ(sut.take<std::uint8_t>(), 5u);
  EXPECT_EQ(sut.take<double>(), 1.0);
  EXPECT_TRUE(sut.ok());
  EXPECT_EQ(sut.left(), 0u);
}

// 7.4.2: XCDR2 aligns 64-bit values to 4 bytes.
TEST(CdrReaderTest, TheSecondEditionAligns64BitValuesTo4) {
  const auto bytes = message({0, 7, 0, 0, 5, 99, 99, 99, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F});
  CdrReader sut(bytes);
  EXPECT_TRUE(sut.second_edition());
  EXPECT_EQ(sut.take<std::uint8_t>(), 5u);
  EXPECT_EQ(sut.take<double>(), 1.0);
  EXPECT_TRUE(sut.ok());
}

TEST(CdrReaderTest, ABigEndianMessageHasTheSameValues) {
  for (const int kind : {0, 6}) {
    const auto bytes =
        message({0, kind, 0, 0, 0x12, 0x34, 99, 99, 0xFF, 0xFF, 0xFF, 0xFE, 0, 0, 0, 2, 'h', 0});
    CdrReader sut(bytes);
    EXPECT_EQ(sut.take<std::int16_t>(), 0x1234);
    EXPECT_EQ(sut.take<std::int32_t>(), -2);
    EXPECT_EQ(sut.take_text(), "h");
    EXPECT_TRUE(sut.ok()) << kind;
  }
}

TEST(CdrReaderTest, ATextMayLackItsFinalZeroAndMayBeEmpty) {
  const auto bytes = message({0, 1, 0, 0, 2,   0,  0,  0,  'a', 'b', 99, 99,  // without a zero
                              1, 0, 0, 0, 0,   99, 99, 99,                    // only the zero
                              0, 0, 0, 0,                                     // not even the zero
                              3, 0, 0, 0, 'c', 0,  0});                       // two zeros
  CdrReader sut(bytes);
  EXPECT_EQ(sut.take_text(), "ab");
  EXPECT_EQ(sut.take_text(), "");
  EXPECT_EQ(sut.take_text(), "");
  EXPECT_EQ(sut.take_text(), std::string_view("c\0", 2));
  EXPECT_TRUE(sut.ok());
}

TEST(CdrReaderTest, AfterAValueThatDoesNotFitEveryValueIsZero) {
  const auto bytes = message({0, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7});
  CdrReader sut(bytes);
  EXPECT_EQ(sut.take<std::uint8_t>(), 1u);
  EXPECT_EQ(sut.take<std::uint64_t>(), 0u);
  EXPECT_FALSE(sut.ok());
  EXPECT_EQ(sut.left(), 0u);
  EXPECT_EQ(sut.take<std::uint8_t>(), 0u) << "it would fit";
  EXPECT_EQ(sut.take_text(), "");
}

TEST(CdrReaderTest, ATextLongerThanTheMessageIsRefused) {
  for (const int high : {0, 0x7F, 0xFF}) {
    const auto bytes = message({0, 1, 0, 0, 3, 0, 0, high, 'a', 'b'});
    CdrReader sut(bytes);
    EXPECT_EQ(sut.take_text(), "");
    EXPECT_FALSE(sut.ok()) << high;
  }
}

TEST(CdrReaderTest, OtherEncapsulationsAndShortMessagesAreRefused) {
  for (int kind = 0; kind < 256; ++kind) {
    const auto bytes = message({0, kind, 0, 0, 1, 0, 0, 0});
    const bool plain = kind == 0 || kind == 1 || kind == 6 || kind == 7;
    EXPECT_EQ(CdrReader(bytes).ok(), plain) << kind;
  }
  EXPECT_FALSE(CdrReader(message({1, 1, 0, 0})).ok());
  EXPECT_TRUE(CdrReader(message({0, 1, 0, 0})).ok()) << "a message without members";
  EXPECT_FALSE(CdrReader(message({0, 1, 0})).ok());
  CdrReader empty{std::span<const std::byte>{}};
  EXPECT_FALSE(empty.ok());
  EXPECT_EQ(empty.take<std::int64_t>(), 0);
}

TEST(CdrReaderTest, NoOrderOfValuesReadsOutsideAMessageOfRandomBytes) {
  std::mt19937 random(13);
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::byte> bytes(4 + random() % 40);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random() % 8);
    bytes[0] = std::byte{0};
    CdrReader sut(bytes);
    for (std::size_t left = sut.left(); sut.ok(); left = sut.left()) {
      switch (random() % 4) {
        case 0:
          (void)sut.take<std::uint8_t>();
          break;
        case 1:
          (void)sut.take<float>();
          break;
        case 2:
          (void)sut.take<std::int64_t>();
          break;
        default:
          ASSERT_LE(sut.take_text().size(), bytes.size());
      }
      if (sut.ok()) {
        ASSERT_LT(sut.left(), left) << "each value takes at least a byte";
      }
    }
    ASSERT_EQ(sut.left(), 0u);
  }
}

}  // namespace
}  // namespace stillhand::recording::cdr_reader_test
