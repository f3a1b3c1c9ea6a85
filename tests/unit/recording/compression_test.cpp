// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/compression.hpp"

#include <gtest/gtest.h>

#include <random>

namespace stillhand::recording::compression_test {
namespace {

using Bytes = std::vector<std::byte>;

Bytes noise(std::size_t count) {
  std::mt19937 random(7);
  Bytes bytes(count);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

class CompressionTest : public testing::TestWithParam<Compression> {
 protected:
  Bytes packed(const Bytes& plain) {
    Compressor sut(GetParam());
    Bytes out;
    EXPECT_TRUE(sut.append(plain, out).ok());
    return out;
  }
};

TEST_P(CompressionTest, UnpacksToWhatWasPacked) {
  // Empty, tiny, noise (grows), and zeros (1000:1, beyond the decoder's first guess).
  for (const Bytes& plain : {Bytes{}, Bytes{std::byte{1}}, noise(100'000), Bytes(5'000'000)}) {
    Bytes out;
    ASSERT_TRUE(unpack(GetParam(), packed(plain), plain.size(), out).ok()) << plain.size();
    EXPECT_EQ(out, plain);
  }
}

TEST_P(CompressionTest, RefusesAWrongSize) {
  const Bytes plain(10'000, std::byte{5});
  Bytes out;
  for (const std::uint64_t size : {std::uint64_t{9'999}, std::uint64_t{10'001}, std::uint64_t{0}}) {
    EXPECT_EQ(unpack(GetParam(), packed(plain), size, out).kind, StatusKind::kDamaged) << size;
  }
}

TEST_P(CompressionTest, RefusesCutOffInput) {
  const Bytes whole = packed(noise(1'000));
  Bytes out;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto part = std::span(whole).first(length);
    ASSERT_EQ(unpack(GetParam(), part, 1'000, out).kind, StatusKind::kDamaged) << length;
  }
}

TEST_P(CompressionTest, AFalseSizeCostsNoMemoryOfThatSize) {
  const Bytes small = packed(Bytes(1'000));
  Bytes out;
  EXPECT_EQ(unpack(GetParam(), small, std::uint64_t{1} << 40, out).kind, StatusKind::kDamaged);
  EXPECT_LT(out.capacity(), std::size_t{1} << 20);
}

TEST_P(CompressionTest, AppendsAndKeepsWhatIsThere) {
  Compressor sut(GetParam());
  Bytes out(3, std::byte{9});
  ASSERT_TRUE(sut.append(noise(50), out).ok());
  EXPECT_EQ(Bytes(out.begin(), out.begin() + 3), Bytes(3, std::byte{9}));
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompressionTest,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kZstd),
                         [](const auto& kind) {
                           const auto name = compression_name(kind.param);
                           return name.empty() ? std::string("none") : std::string(name);
                         });

TEST(CompressionNameTest, NamesAndKindsMatch) {
  for (const auto kind : {Compression::kNone, Compression::kLz4, Compression::kZstd}) {
    EXPECT_EQ(compression_of(compression_name(kind)), kind);
  }
  EXPECT_EQ(compression_of("bz2"), std::nullopt);
}

}  // namespace
}  // namespace stillhand::recording::compression_test
