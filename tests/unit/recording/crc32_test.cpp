// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/crc32.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace stillhand::recording::crc32_test {
namespace {

std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

TEST(Crc32Test, GivesTheCheckValueOfTheStandard) {
  // "check" of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms (G. Cook).
  EXPECT_EQ(crc32(bytes("123456789")), 0xCBF43926u);
}

TEST(Crc32Test, PiecesGiveTheSameAsTheWhole) {
  EXPECT_EQ(crc32(bytes("456789"), crc32(bytes("123"))), crc32(bytes("123456789")));
}

TEST(Crc32Test, AnEmptyPieceChangesNothing) {
  EXPECT_EQ(crc32({}), 0u);
  EXPECT_EQ(crc32({}, 0x12345678u), 0x12345678u);
}

}  // namespace
}  // namespace stillhand::recording::crc32_test
