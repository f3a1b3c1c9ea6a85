// SPDX-License-Identifier: Apache-2.0
#include "services/bus/batched/rtps_sample.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace stillhand::runtime {
namespace {

using Bytes = std::vector<std::byte>;

Bytes operator+(Bytes front, const Bytes& back) {
  front.insert(front.end(), back.begin(), back.end());
  return front;
}

Bytes text(const std::string& characters) {
  Bytes bytes(characters.size());
  std::memcpy(bytes.data(), characters.data(), characters.size());
  return bytes;
}

template <typename Number>
Bytes number(Number value) {
  Bytes bytes(sizeof(value));
  std::memcpy(bytes.data(), &value, sizeof(value));
  return bytes;
}

/// RTPS 2.3, 9.4.5: id, flags, length, body.
Bytes submessage(std::uint8_t id, std::uint8_t flags, const Bytes& body) {
  return number(id) + number(flags) + number(static_cast<std::uint16_t>(body.size())) + body;
}

const std::string kPrefix = "wwwwwwwwwwww", kWriter = "WRTR", kOwn = "oooooooooooo";
const Bytes kHeader =
    text("RTPS") + Bytes{std::byte{2}, std::byte{2}, std::byte{1}, std::byte{15}} + text(kPrefix);
const Bytes kForUs = submessage(0x0e, 1, text(kOwn));
const Bytes kStamp = submessage(0x09, 1, number(std::int32_t{1'700'000'000}) + number(0x80000000U));
const Bytes kPayload = text("\1") + text("the sample's bytes");

Bytes data_head(std::int32_t high, std::uint32_t low, std::uint16_t to_qos = 16) {
  return number(std::uint16_t{0}) + number(to_qos) + text("RDER") + text(kWriter) + number(high) +
         number(low);
}

Bytes data(std::uint8_t flags = 5) { return submessage(0x15, flags, data_head(1, 7) + kPayload); }

TEST(RtpsSampleTest, ASampleIsReadAsItsWriterSentIt) {
  const Bytes datagram = kHeader + kForUs + kStamp + data();
  const auto got = only_sample(datagram);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(std::memcmp(got->destination.data(), kOwn.data(), 12), 0);
  EXPECT_EQ(std::memcmp(got->writer.data(), (kPrefix + kWriter).data(), 16), 0);
  EXPECT_EQ(got->sequence, (std::int64_t{1} << 32) + 7);
  EXPECT_EQ(got->sent_s, 1'700'000'000);
  EXPECT_EQ(got->sent_fraction, 0x80000000U);
  EXPECT_EQ(Bytes(got->bytes.begin(), got->bytes.end()), kPayload);
}

TEST(RtpsSampleTest, ParametersBeforeTheSampleArePassedOver) {
  const Bytes key = number(std::uint16_t{0x70}) + number(std::uint16_t{16}) + text(kOwn + "1234");
  const Bytes end = number(std::uint16_t{1}) + number(std::uint16_t{0});
  const auto got =
      only_sample(kHeader + kStamp + submessage(0x15, 7, data_head(0, 1) + key + end + kPayload));
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->bytes.size(), kPayload.size());
  // Without an end, or with one behind the message's own.
  EXPECT_FALSE(only_sample(kHeader + kStamp + submessage(0x15, 7, data_head(0, 1) + key)));
  const Bytes far = number(std::uint16_t{0x70}) + number(std::uint16_t{60000});
  EXPECT_FALSE(only_sample(kHeader + kStamp + submessage(0x15, 7, data_head(0, 1) + far + end)));
}

TEST(RtpsSampleTest, TheLastOneMayLeaveItsLengthOut) {
  Bytes open = data();
  open[2] = open[3] = std::byte{0};
  const auto got = only_sample(kHeader + kStamp + open);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->bytes.size(), kPayload.size());
}

TEST(RtpsSampleTest, WhatAVendorAddsIsPassedOver) {
  const Bytes own = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(only_sample(kHeader + own + kStamp + data() + own));
  EXPECT_FALSE(only_sample(kHeader + kStamp + data() + own + data()));
}

TEST(RtpsSampleTest, WhatAsksForMoreIsLeftToDds) {
  const Bytes heartbeat = submessage(0x07, 1, Bytes(28));
  const Bytes others[]{
      kHeader + kStamp,                            // no sample
      kHeader + data(),                            // no stamp
      kHeader + kStamp + data() + data(),          // two
      kHeader + kStamp + data() + heartbeat,       // an answer is awaited
      kHeader + kStamp + data(9),                  // an instance's end: a key, no data
      kHeader + kStamp + data(4),                  // big-endian
      kHeader + submessage(0x09, 3, {}) + data(),  // the stamp taken back
      kHeader + submessage(0x33, 1, Bytes(20)),    // SRTPS_PREFIX: DDS Security
      kHeader + kStamp + submessage(0x16, 5, data_head(0, 1) + kPayload),      // a fragment
      kHeader + kStamp + submessage(0x15, 5, data_head(0, 0) + kPayload),      // no such number
      kHeader + kStamp + submessage(0x15, 5, data_head(-1, 1) + kPayload),     // nor such
      kHeader + kStamp + submessage(0x15, 5, data_head(0, 1, 12) + kPayload),  // a head too short
      kHeader + kStamp + submessage(0x15, 5, data_head(0, 1)),                 // nothing behind it
      text("RTPX") + Bytes(kHeader.begin() + 4, kHeader.end()) + kStamp + data(),
      {}};
  for (const Bytes& other : others) EXPECT_FALSE(only_sample(other)) << (&other - others);
}

// In a block of its own size, so that the address sanitizer sees a byte too many.
TEST(RtpsSampleTest, NoDatagramLeadsOutsideOfItself) {
  std::mt19937 random(11);
  const Bytes good = kHeader + kForUs + kStamp + data(7) + data();
  int taken = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes spoilt = i % 2 == 0 ? good : kHeader + kForUs + kStamp + data();
    for (std::size_t flips = random() % 4; flips > 0; --flips) {
      spoilt[random() % spoilt.size()] = static_cast<std::byte>(random());
    }
    if (random() % 3 == 0) spoilt.resize(random() % (spoilt.size() + 1));
    const auto exact = std::make_unique<std::byte[]>(spoilt.size());
    std::memcpy(exact.get(), spoilt.data(), spoilt.size());
    const auto got = only_sample({exact.get(), spoilt.size()});
    if (!got) continue;
    ++taken;
    ASSERT_GE(got->bytes.data(), exact.get());
    ASSERT_LE(got->bytes.data() + got->bytes.size(), exact.get() + spoilt.size());
    ASSERT_GT(got->sequence, 0);
  }
  EXPECT_GT(taken, 10'000);
}

}  // namespace
}  // namespace stillhand::runtime
