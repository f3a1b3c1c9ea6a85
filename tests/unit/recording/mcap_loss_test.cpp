// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_loss.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace stillhand::recording::mcap_loss_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Damage damage(DamageKind kind, std::uint64_t offset, std::uint64_t lost, std::string text = "why") {
  return {kind, offset, lost, std::move(text)};
}

TEST(ByteCountTest, BytesHaveADecimalPrefixFrom1000On) {
  EXPECT_EQ(byte_count(0), "0 bytes");
  EXPECT_EQ(byte_count(1), "1 byte");
  EXPECT_EQ(byte_count(999), "999 bytes");
  EXPECT_EQ(byte_count(1000), "1 kB");
  EXPECT_EQ(byte_count(1234), "1.23 kB");
  EXPECT_EQ(byte_count(5'600'000), "5.6 MB");
  EXPECT_EQ(byte_count(7'000'000'000), "7 GB");
  EXPECT_EQ(byte_count(8'250'000'000'000), "8.25 TB");
  // One that rounds to 1000 has the next prefix.
  EXPECT_EQ(byte_count(999'499), "999 kB");
  EXPECT_EQ(byte_count(999'999), "1 MB");
  EXPECT_EQ(byte_count(999'999'999), "1 GB");
  EXPECT_EQ(byte_count(999'999'999'999), "1 TB");
  EXPECT_EQ(byte_count(UINT64_MAX), "18.4 EB");
}

// Three digits: the text differs from the count by at most half of its last digit, which is at most
// 0.5 % (at 1.00).
TEST(ByteCountTest, EveryCountReadsBackToHalfAPercentWithoutAnExponent) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 20'000; ++round) {
    const std::uint64_t bytes = random() >> (random() % 64);
    const std::string text = byte_count(bytes);
    ASSERT_EQ(text.find("e+"), std::string::npos) << text;
    double value = std::strtod(text.c_str(), nullptr);
    const std::size_t prefix = std::string("kMGTPE").find(text[text.find(' ') + 1]);
    if (prefix != std::string::npos) value *= std::pow(1000.0, static_cast<double>(prefix + 1));
    ASSERT_NEAR(value, static_cast<double>(bytes), 0.00501 * static_cast<double>(bytes)) << text;
  }
}

TEST(LossLineTest, AWholeRecordingHasNoneAndAnOpenOrCutOneSaysWhatIsLost) {
  const Damage open = damage(DamageKind::kNoFooter, 9, 0);
  EXPECT_EQ(loss_line("a.mcap", std::vector<Damage>{}, 12, false), "");
  EXPECT_THAT(loss_line("a.mcap", {damage(DamageKind::kCutOff, 5, 100)}, std::nullopt, true),
              AllOf(HasSubstr("a.mcap: "), HasSubstr("written"), Not(HasSubstr("100"))));
  EXPECT_THAT(loss_line("a.mcap", {open}, 12, false),
              AllOf(HasSubstr("a.mcap: "), HasSubstr("closed"), Not(HasSubstr("byte")),
                    HasSubstr("12 messages")));
  EXPECT_THAT(loss_line("a.mcap", {open, damage(DamageKind::kCutOff, 5, 1500)}, 12, false),
              AllOf(HasSubstr("cut off"), HasSubstr("1.5 kB lost"), HasSubstr("12 messages"),
                    Not(HasSubstr("place"))));
}

TEST(LossLineTest, ADamagedFileNamesTheWorstPlaceAndTheNumberOfPlaces) {
  const std::string line = loss_line("a.mcap",
                                     {damage(DamageKind::kBadChunk, 100, 20, "small"),
                                      damage(DamageKind::kBadRecord, 300, 50, "large"),
                                      damage(DamageKind::kNoFooter, 900, 0, "footer")},
                                     std::nullopt, false);
  EXPECT_THAT(line, AllOf(HasSubstr("2 places"), HasSubstr("70 bytes lost"),
                          HasSubstr("byte 300: large"), Not(HasSubstr("small")),
                          HasSubstr("stillhand verify"), Not(HasSubstr("messages"))));
  EXPECT_THAT(loss_line("a.mcap", {damage(DamageKind::kBadChunk, 100, 20)}, 3, false),
              AllOf(HasSubstr("1 place;"), HasSubstr("3 messages")));
  // A footer that lost bytes is damage, not an open end.
  EXPECT_THAT(loss_line("a.mcap", {damage(DamageKind::kNoFooter, 100, 20, "footer")}, 3, false),
              AllOf(HasSubstr("1 place"), HasSubstr("20 bytes lost")));
}

}  // namespace
}  // namespace stillhand::recording::mcap_loss_test
