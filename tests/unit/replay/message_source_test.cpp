// SPDX-License-Identifier: Apache-2.0
// Real files in a folder of the test's own.
#include "apps/replay/message_source.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "services/core/recording/mcap/mcap_writer.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::replay::message_source_test {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000;

struct Note {
  recording::ChannelId channel;
  std::uint64_t time_ns;
  bool operator==(const Note&) const = default;
};

class MessageSourceTest : public testing::Test {
 protected:
  /// A file of two channels, 0 and 1, with these messages in this order.
  std::string file_of(const std::vector<Note>& notes) const {
    const std::string path = (folder_ / "f.mcap").string();
    recording::FileSink sink(path, recording::Existing::kReplace);
    recording::McapWriterOptions options;
    options.chunk_bytes = 256;
    recording::McapWriter writer(sink, options);
    writer.add_channel("a", 0, "cdr");
    writer.add_channel("b", 0, "cdr");
    for (const Note& note : notes) {
      EXPECT_TRUE(writer.write(note.channel, 0, note.time_ns, 0, {}).ok());
    }
    EXPECT_TRUE(writer.close().ok());
    return path;
  }

  /// All there is to the end; the first stretch, the state before, is not among them.
  static std::vector<Note> rest(MessageSource& source) {
    std::vector<Note> notes;
    for (bool last = false; !last;) {
      const Stretch stretch = source.wait_next();
      for (const auto& message : stretch.batch.messages) {
        notes.push_back({static_cast<recording::ChannelId>(message.channel), message.log_time_ns});
      }
      last = stretch.last;
    }
    return notes;
  }

  const support::Folder folder_;
};

TEST_F(MessageSourceTest, ComesInTheOrderOfTimeWhateverTheOrderOfTheFile) {
  std::vector<Note> notes;
  for (std::uint64_t i = 0; i < 500; ++i) {
    notes.push_back({static_cast<recording::ChannelId>(i % 2), (i * 7919 % 500) * 10'000'000});
  }
  recording::FileSource file(file_of(notes));
  MessageSource sut(file, {0, 1}, {});
  sut.seek(0, UINT64_MAX);
  const auto found = rest(sut);
  std::ranges::stable_sort(notes, {}, &Note::time_ns);
  EXPECT_EQ(found, notes);
}

TEST_F(MessageSourceTest, OnlyWhatIsWantedAndOnlyUpToTheEnd) {
  recording::FileSource file(file_of({{0, 1}, {1, 2}, {0, 3}, {0, 4}, {0, 5}}));
  MessageSource sut(file, {0}, {});
  sut.seek(2, 4);
  EXPECT_EQ(rest(sut), (std::vector<Note>{{0, 3}, {0, 4}}));
}

// 584 years in stretches of a second would never end.
TEST_F(MessageSourceTest, AGapOfCenturiesIsCrossed) {
  const std::vector<Note> notes{{0, 5}, {0, 1'700'000'000 * kSecond}, {0, UINT64_MAX - 1}};
  recording::FileSource file(file_of(notes));
  MessageSource sut(file, {0}, {});
  sut.seek(0, UINT64_MAX);
  EXPECT_EQ(rest(sut), notes);
}

TEST_F(MessageSourceTest, ASeekBringsTheNewestStateOfEachLatchedChannelFirst) {
  recording::FileSource file(
      file_of({{0, 1}, {1, 2}, {1, 3 * kSecond}, {0, 4 * kSecond}, {1, 9 * kSecond}}));
  MessageSource sut(file, {0, 1}, {1});
  sut.seek(5 * kSecond, UINT64_MAX);
  const Stretch state = sut.wait_next();
  ASSERT_EQ(state.batch.messages.size(), 1u);
  EXPECT_EQ(state.batch.messages[0].channel, 1u);
  EXPECT_EQ(state.batch.messages[0].log_time_ns, 5 * kSecond);  // due at the instant sought
  EXPECT_EQ(rest(sut), (std::vector<Note>{{1, 9 * kSecond}}));
}

TEST_F(MessageSourceTest, AfterASeekNothingOfBeforeComes) {
  std::vector<Note> notes;
  for (std::uint64_t i = 0; i < 60; ++i) notes.push_back({0, i * kSecond});
  recording::FileSource file(file_of(notes));
  MessageSource sut(file, {0}, {});
  sut.seek(0, UINT64_MAX);
  sut.wait_next();
  for (const std::uint64_t from : {30u, 10u, 50u}) {
    sut.seek(from * kSecond, UINT64_MAX);
    EXPECT_TRUE(sut.wait_next().batch.messages.empty());  // no latched channel
    const auto found = rest(sut);
    ASSERT_EQ(found.size(), 60 - from);
    EXPECT_EQ(found.front().time_ns, from * kSecond);
  }
}

TEST_F(MessageSourceTest, AnEndBeforeTheStartIsAnEmptyLastStretch) {
  recording::FileSource file(file_of({{0, 1}, {0, 5}, {0, 9}}));
  MessageSource sut(file, {0}, {});
  sut.seek(6, 4);
  EXPECT_TRUE(rest(sut).empty());
}

TEST_F(MessageSourceTest, OfStatesAtTheSameTimeTheLaterInTheFileCounts) {
  const std::string path = (folder_ / "tie.mcap").string();
  {
    recording::FileSink sink(path, recording::Existing::kReplace);
    recording::McapWriter writer(sink, {});
    writer.add_channel("a", 0, "cdr");
    for (std::uint32_t sequence = 1; sequence <= 3; ++sequence) {
      ASSERT_TRUE(writer.write(0, sequence, 7, 0, {}).ok());
    }
    ASSERT_TRUE(writer.close().ok());
  }
  recording::FileSource file(path);
  MessageSource sut(file, {0}, {0});
  sut.seek(8, UINT64_MAX);
  const Stretch state = sut.wait_next();
  ASSERT_EQ(state.batch.messages.size(), 1u);
  EXPECT_EQ(state.batch.messages[0].sequence, 3u);
}

TEST_F(MessageSourceTest, DamageIsReportedAndTheOtherChunksStillCome) {
  std::vector<Note> notes;
  for (std::uint64_t i = 0; i < 200; ++i) notes.push_back({0, i});
  const std::string path = file_of(notes);
  {
    // A chunk of eight messages and its index take some 280 bytes: at least one chunk is hit.
    std::fstream bytes(path, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 4));
    bytes << std::string(400, '\xff');
  }
  recording::FileSource file(path);
  MessageSource sut(file, {0}, {});
  sut.seek(0, UINT64_MAX);
  const auto found = rest(sut);
  EXPECT_FALSE(sut.damage().empty());
  EXPECT_GT(found.size(), 100u);
  EXPECT_LT(found.size(), 200u);
}

// Oracle: the same selection by the definition, over the whole list.
TEST_F(MessageSourceTest, AnySeekGivesTheStateOfBeforeAndTheMessagesOfItsSpan) {
  std::mt19937 random(20261123);
  const auto below = [&](std::uint64_t limit) {
    return std::uniform_int_distribution<std::uint64_t>(0, limit - 1)(random);
  };
  std::vector<Note> notes;
  for (int i = 0; i < 400; ++i) {
    notes.push_back({static_cast<recording::ChannelId>(below(2)), below(30 * kSecond)});
  }
  recording::FileSource file(file_of(notes));
  MessageSource sut(file, {0, 1}, {1});
  for (int turn = 0; turn < 20; ++turn) {
    const std::uint64_t from = below(32 * kSecond), to = from + below(10 * kSecond);
    sut.seek(from, to);
    std::vector<Note> want;
    std::optional<std::uint64_t> newest;
    for (const Note& note : notes) {
      if (note.time_ns >= from && note.time_ns <= to) want.push_back(note);
      if (note.channel == 1 && note.time_ns < from) {
        newest = std::max(newest.value_or(0), note.time_ns);
      }
    }
    std::ranges::stable_sort(want, {}, &Note::time_ns);
    const Stretch state = sut.wait_next();
    ASSERT_EQ(state.batch.messages.size(), newest ? 1u : 0u) << "from " << from;
    for (const auto& message : state.batch.messages) EXPECT_EQ(message.log_time_ns, from);
    ASSERT_EQ(rest(sut), want) << "from " << from << " to " << to;
  }
}

}  // namespace
}  // namespace stillhand::replay::message_source_test
