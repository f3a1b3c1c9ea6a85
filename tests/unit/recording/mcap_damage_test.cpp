// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "tests/support/memory_bytes.hpp"
#include "tests/support/recorded_file.hpp"

namespace stillhand::recording::mcap_damage_test {
namespace {

using tests::Bytes;
using tests::messages_of;
using tests::plain_message;
using tests::PlainMessage;
using tests::recorded_file;

constexpr std::uint32_t kCount = 30;
constexpr std::size_t kChunkBytes = 400;

struct Chunk {
  std::size_t end;  // [B] offset in the file behind it
  std::vector<PlainMessage> messages;
};

// The chunks of a whole file: a chunk is complete once cutting the file behind it keeps it.
// Found with a writer of its own, so that the reader under test is no oracle for itself.
std::vector<Chunk> chunks_of(Compression compression) {
  MemorySink sink;
  McapWriter writer(sink, {kChunkBytes, compression, "stillhand-test"});
  EXPECT_TRUE(writer.add_metadata("session", {{"seed", "42"}, {"subject", "S03"}}).ok());
  const auto schema = writer.add_schema("P", "omgidl", "struct P { octet x; };");
  const auto even = writer.add_channel("even", schema, "cdr", {{"qos", "stream_1khz"}});
  const auto odd = writer.add_channel("odd", schema, "cdr");
  std::vector<Chunk> chunks(1);
  for (std::uint32_t n = 0; n < kCount; ++n) {
    const auto before = writer.statistics().chunk_count;
    const PlainMessage m = plain_message(n);
    EXPECT_TRUE(
        writer.write(n % 2 == 0 ? even : odd, n, m.log_time_ns, m.publish_time_ns, m.bytes).ok());
    chunks.back().messages.push_back(m);
    if (writer.statistics().chunk_count == before && n + 1 < kCount) continue;
    if (writer.statistics().chunk_count == before) {  // the last one, as recorded_file() ends
      EXPECT_TRUE(writer.add_metadata("result", {{"trial", "done"}}).ok());
      EXPECT_TRUE(writer.flush_chunk().ok());
    }
    // Behind the chunk lie its message indexes: 9 + 6 + 16 bytes a message each, see FORMAT.md.
    std::size_t index_bytes = 0;
    for (const char* topic : {"even", "odd"}) {
      const auto count = static_cast<std::size_t>(
          std::ranges::count(chunks.back().messages, topic, &PlainMessage::topic));
      index_bytes += count == 0 ? 0 : 9 + 6 + 16 * count;
    }
    chunks.back().end = static_cast<std::size_t>(sink.size()) - index_bytes;
    chunks.emplace_back();
  }
  chunks.pop_back();
  return chunks;
}

class McapDamageTest : public testing::TestWithParam<Compression> {
 protected:
  const std::vector<Chunk> chunks_ = chunks_of(GetParam());
  const Bytes closed_ = recorded_file(kCount, GetParam(), kChunkBytes);
  const Bytes crashed_{closed_.begin(),
                       closed_.begin() + static_cast<std::ptrdiff_t>(chunks_.back().end)};

  // Chunks that miss a message in `messages`, which must hold nothing but messages as written.
  std::size_t lost_chunks(const std::vector<PlainMessage>& messages) {
    std::size_t lost = 0;
    std::size_t next = 0;
    for (const Chunk& chunk : chunks_) {
      const bool whole = next + chunk.messages.size() <= messages.size() &&
                         std::equal(chunk.messages.begin(), chunk.messages.end(),
                                    messages.begin() + static_cast<std::ptrdiff_t>(next));
      if (whole) next += chunk.messages.size();
      lost += whole ? 0 : 1;
    }
    EXPECT_EQ(next, messages.size()) << "a message that was never written";
    return lost;
  }
};

TEST_P(McapDamageTest, TheTestFileHasSeveralChunks) { EXPECT_GE(chunks_.size(), 4u); }

TEST_P(McapDamageTest, CutAnywhereEveryCompleteChunkIsRecovered) {
  std::size_t before = 0;
  for (std::size_t length = 8; length < closed_.size(); ++length) {
    const Bytes cut(closed_.begin(), closed_.begin() + static_cast<std::ptrdiff_t>(length));
    MemorySource source(cut);
    McapReader sut(source);
    ASSERT_TRUE(sut.status().ok()) << length;
    std::vector<PlainMessage> expected;
    for (const Chunk& chunk : chunks_) {
      if (chunk.end <= length) {
        expected.insert(expected.end(), chunk.messages.begin(), chunk.messages.end());
      }
    }
    const auto messages = messages_of(sut);
    ASSERT_EQ(messages, expected) << "cut to " << length;
    ASSERT_GE(messages.size(), before) << "cut to " << length;
    before = messages.size();
    ASSERT_FALSE(sut.damage().empty()) << "cut to " << length;
    ASSERT_EQ(sut.statistics().message_count, messages.size());
  }
  EXPECT_EQ(before, kCount);
}

TEST_P(McapDamageTest, WhatACutDropsIsCounted) {
  // 10 bytes into the second chunk: those 10 bytes are lost, no more and no less.
  const std::size_t index_bytes =
      2 * (9 + 6) + 16 * chunks_[0].messages.size();  // both topics are in the first chunk
  const std::size_t length = chunks_[0].end + index_bytes + 10;
  const Bytes cut(closed_.begin(), closed_.begin() + static_cast<std::ptrdiff_t>(length));
  MemorySource source(cut);
  McapReader sut(source);
  EXPECT_EQ(sut.lost_bytes(), 10u);
  EXPECT_THAT(sut.damage(), testing::Contains(testing::Field(&Damage::kind, DamageKind::kCutOff)));
  EXPECT_THAT(sut.damage(),
              testing::Contains(testing::Field(&Damage::kind, DamageKind::kNoFooter)));
}

TEST_P(McapDamageTest, OneFlippedBitCostsAtMostItsChunkAlsoAfterACrashAndIsSaid) {
  for (const Bytes& whole : {closed_, crashed_}) {
    for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
      Bytes flipped = whole;
      flipped[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
      MemorySource source(flipped);
      McapReader sut(source);
      ASSERT_TRUE(sut.status().ok()) << bit;
      const std::size_t lost = lost_chunks(messages_of(sut));
      ASSERT_LE(lost, 1u) << "byte " << bit / 8 << " bit " << bit % 8;
      ASSERT_TRUE(lost == 0 || sut.lost_bytes() > 0) << "byte " << bit / 8 << " bit " << bit % 8;
      if (whole.size() == crashed_.size()) continue;
      ASSERT_TRUE(sut.verify().ok());
      ASSERT_FALSE(sut.damage().empty()) << "byte " << bit / 8 << " bit " << bit % 8;
    }
  }
}

// What a disk gives for a page that it never wrote, from smaller than the head of a chunk to larger
// than a chunk, at every place.
TEST_P(McapDamageTest, APageOfZerosCostsTheChunksThatItTouchesAndIsSaid) {
  for (const Bytes& whole : {closed_, crashed_}) {
    for (const std::size_t page : {std::size_t{9}, std::size_t{100}, 2 * kChunkBytes}) {
      for (std::size_t at = kMagic.size(); at + page <= whole.size(); ++at) {
        Bytes file = whole;
        std::fill_n(file.begin() + static_cast<std::ptrdiff_t>(at), page, std::byte{0});
        MemorySource source(file);
        McapReader sut(source);
        ASSERT_TRUE(sut.status().ok()) << at;
        const std::size_t lost = lost_chunks(messages_of(sut));
        // A page touches as many chunks as fit into it, and one more at each end.
        ASSERT_LE(lost, page / kChunkBytes + 2) << at;
        ASSERT_TRUE(lost == 0 || sut.lost_bytes() > 0) << at;
      }
    }
  }
}

TEST_P(McapDamageTest, ATailOfZerosAfterALossOfPowerIsDropped) {
  Bytes file = crashed_;
  file.resize(file.size() + 5000);
  MemorySource source(file);
  McapReader sut(source);
  EXPECT_EQ(lost_chunks(messages_of(sut)), 0u);
  EXPECT_EQ(sut.lost_bytes(), 5000u);
}

// Every 4- and 8-byte field anywhere, as a length far beyond the file: nothing of that size may be
// allocated.  The sanitizers' allocator refuses such sizes; plain builds would throw bad_alloc.
TEST_P(McapDamageTest, LengthsBeyondTheFileAreRefused) {
  for (const Bytes& whole : {closed_, crashed_}) {
    for (std::size_t at = 8; at + 8 <= whole.size(); ++at) {
      for (const std::uint64_t length :
           {std::uint64_t{0xFFFFFFFF}, std::uint64_t{1} << 62, UINT64_MAX}) {
        Bytes file = whole;
        const std::size_t width = length == 0xFFFFFFFF ? 4 : 8;
        for (std::size_t i = 0; i < width; ++i) {
          file[at + i] = static_cast<std::byte>(length >> (8 * i));
        }
        MemorySource source(file);
        McapReader sut(source);
        ASSERT_TRUE(sut.status().ok()) << at;
        (void)messages_of(sut);
        ASSERT_TRUE(sut.verify().ok());
      }
    }
  }
}

TEST_P(McapDamageTest, AChunkThatUnpacksToMoreThanAllowedIsNotRead) {
  MemorySink sink;
  McapWriter writer(sink, {std::size_t{1} << 20, GetParam()});
  const auto channel = writer.add_channel("p", 0, "cdr");
  ASSERT_TRUE(writer.write(channel, 0, 1, 1, Bytes(100'000)).ok());
  ASSERT_TRUE(writer.close().ok());
  MemorySource source(sink.bytes());
  McapReader sut(source, {50'000});
  EXPECT_TRUE(messages_of(sut).empty());
  EXPECT_THAT(sut.damage(),
              testing::Contains(testing::Field(&Damage::kind, DamageKind::kTooLarge)));
}

Bytes mutated(Bytes file, std::mt19937_64& random) {
  const auto place = [&] { return static_cast<std::ptrdiff_t>(random() % (file.size() + 1)); };
  const auto steps = 1 + random() % 4;
  for (std::uint64_t step = 0; step < steps && !file.empty(); ++step) {
    const std::ptrdiff_t at = place();
    const std::ptrdiff_t room = static_cast<std::ptrdiff_t>(file.size()) - at;
    const auto length = std::min(room, static_cast<std::ptrdiff_t>(random() % 64));
    switch (random() % 5) {
      case 0:  // other bytes
        for (std::ptrdiff_t i = 0; i < length; ++i) {
          file[static_cast<std::size_t>(at + i)] = static_cast<std::byte>(random());
        }
        break;
      case 1:  // missing bytes
        file.erase(file.begin() + at, file.begin() + at + length);
        break;
      case 2: {  // bytes twice
        const Bytes copy(file.begin() + at, file.begin() + at + length);
        file.insert(file.begin() + place(), copy.begin(), copy.end());
        break;
      }
      case 3:  // an extreme number
        for (std::ptrdiff_t i = 0; i < std::min<std::ptrdiff_t>(room, 8); ++i) {
          file[static_cast<std::size_t>(at + i)] = static_cast<std::byte>(random() % 2 * 255);
        }
        break;
      default:  // cut
        file.resize(static_cast<std::size_t>(at));
        break;
    }
  }
  return file;
}

// With two checksums over everything, a wrong message that goes unsaid has a chance of 2^-32.
TEST_P(McapDamageTest, TwentyThousandMutationsNeitherCrashNorGoUnsaid) {
  std::mt19937_64 random(20250101);
  std::vector<PlainMessage> original;
  for (std::uint32_t n = 0; n < kCount; ++n) original.push_back(plain_message(n));
  constexpr int kRounds = 20'000;
  for (int round = 0; round < kRounds; ++round) {
    const Bytes file = mutated(round % 4 == 0 ? crashed_ : closed_, random);
    MemorySource source(file);
    McapReader sut(source, {1u << 20});
    const auto messages = messages_of(sut);
    const bool said = !sut.verify().ok() || !sut.damage().empty();
    ASSERT_TRUE(said || messages == original) << "round " << round;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, McapDamageTest,
                         testing::Values(Compression::kNone, Compression::kLz4,
                                         Compression::kZstd));

}  // namespace
}  // namespace stillhand::recording::mcap_damage_test
