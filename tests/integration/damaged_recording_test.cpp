// SPDX-License-Identifier: Apache-2.0
// A live session's recording, damaged at every boundary of its records: cut there, a byte before
// and behind, and with a bit flipped in the opcode, the length and the first byte of the content.
// Nothing crashes, at most the chunk concerned is lost, and what is lost is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "services/core/recording/mcap/crc32.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/memory_bytes.hpp"

namespace stillhand::recording {
namespace {

using Bytes = std::vector<std::byte>;

// Of the recording's start; 60 MB of the whole a thousand times over would take an hour.
constexpr std::size_t kTakenBytes = 1'000'000;

struct Record {
  std::size_t begin;
  std::size_t end;
  bool is_chunk;
};

// By heads alone, as FORMAT.md describes them: the reader under test is no oracle for itself.
std::vector<Record> records_of(const Bytes& file) {
  std::vector<Record> records;
  for (std::size_t at = kMagic.size(); at + 9 <= file.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, file.data() + at + 1, sizeof(length));
    if (length > file.size() - at - 9) break;
    const std::size_t end = at + 9 + static_cast<std::size_t>(length);
    records.push_back({at, end, file[at] == std::byte{6}});
    at = end;
  }
  return records;
}

// Messages as a reader delivers them, each by a checksum of all it consists of.
std::vector<std::uint32_t> messages_of(McapReader& reader) {
  std::vector<std::uint32_t> messages;
  EXPECT_TRUE(reader
                  .for_each_message({},
                                    [&](const MessageView& message) {
                                      std::uint32_t sum = crc32(message.bytes);
                                      const auto mix = [&](auto value) {
                                        sum = crc32(std::as_bytes(std::span(&value, 1)), sum);
                                      };
                                      mix(message.channel.id);
                                      mix(message.sequence);
                                      mix(message.log_time_ns);
                                      mix(message.publish_time_ns);
                                      messages.push_back(sum);
                                      return true;
                                    })
                  .ok());
  return messages;
}

class DamagedRecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* path = std::getenv("STILLHAND_RECORDING");
    ASSERT_NE(path, nullptr) << "the fixture lab_run sets it";
    FileSource source(path);
    file_.resize(std::min<std::size_t>(kTakenBytes, source.size()));
    ASSERT_TRUE(source.read_at(0, file_).ok());
    records_ = records_of(file_);
    file_.resize(records_.back().end);  // as a crash right after it leaves the file
    std::size_t messages = 0;
    for (const Record& record : records_) {
      if (!record.is_chunk) continue;
      const std::size_t now = count_up_to(record.end);
      of_chunk_.push_back(now - messages);
      messages = now;
    }
    ASSERT_GE(of_chunk_.size(), 5u) << "a recording of several chunks";
    MemorySource memory(file_);
    McapReader reader(memory);
    whole_ = messages_of(reader);
    ASSERT_EQ(whole_.size(), messages);
  }

  std::size_t count_up_to(std::size_t length) {
    const Bytes cut(file_.begin(), file_.begin() + static_cast<std::ptrdiff_t>(length));
    MemorySource source(cut);
    McapReader reader(source);
    return messages_of(reader).size();
  }

  // What must be there: all messages but those of one chunk.
  void expect_all_but_one_chunk(const Bytes& file, const std::string& what) {
    MemorySource source(file);
    McapReader sut(source);
    ASSERT_TRUE(sut.status().ok()) << what;
    const std::vector<std::uint32_t> found = messages_of(sut);
    if (found != whole_) {
      bool fits = false;
      std::size_t before = 0;
      for (const std::size_t count : of_chunk_) {
        if (found.size() + count == whole_.size()) {
          const auto gap = static_cast<std::ptrdiff_t>(before);
          fits = fits || (std::equal(found.begin(), found.begin() + gap, whole_.begin()) &&
                          std::equal(found.begin() + gap, found.end(),
                                     whole_.begin() + gap + static_cast<std::ptrdiff_t>(count)));
        }
        before += count;
      }
      ASSERT_TRUE(fits) << what << ": " << found.size() << " of " << whole_.size() << " messages";
      ASSERT_GT(sut.lost_bytes(), 0u) << what;
    }
    ASSERT_FALSE(sut.damage().empty()) << what;
  }

  Bytes file_;
  std::vector<Record> records_;
  std::vector<std::size_t> of_chunk_;  // messages in each chunk
  std::vector<std::uint32_t> whole_;
};

TEST_F(DamagedRecordingTest, CutAtEveryBoundaryEveryCompleteChunkIsThere) {
  for (const Record& record : records_) {
    for (const std::ptrdiff_t off : {-1, 0, 1}) {
      const std::ptrdiff_t wanted = static_cast<std::ptrdiff_t>(record.end) + off;
      const auto length = std::min(static_cast<std::size_t>(wanted), file_.size());
      std::size_t expected = 0;
      std::size_t chunk = 0;
      for (const Record& other : records_) {
        if (!other.is_chunk) continue;
        if (other.end <= length) expected += of_chunk_[chunk];
        ++chunk;
      }
      const Bytes cut(file_.begin(), file_.begin() + static_cast<std::ptrdiff_t>(length));
      MemorySource source(cut);
      McapReader sut(source);
      ASSERT_TRUE(sut.status().ok()) << "cut to " << length;
      const auto found = messages_of(sut);
      ASSERT_EQ(found.size(), expected) << "cut to " << length;
      ASSERT_TRUE(std::equal(found.begin(), found.end(), whole_.begin())) << "cut to " << length;
      ASSERT_FALSE(sut.damage().empty()) << "cut to " << length;
    }
  }
}

TEST_F(DamagedRecordingTest, ABitFlippedAtEveryBoundaryCostsAtMostItsChunk) {
  std::size_t place = 0;
  for (const Record& record : records_) {
    for (const std::size_t byte :
         {std::size_t{0}, std::size_t{1}, std::size_t{4}, std::size_t{9}}) {
      Bytes flipped = file_;
      const std::size_t bit = place++ % 8;
      flipped[record.begin + byte] ^= static_cast<std::byte>(1u << bit);
      expect_all_but_one_chunk(flipped, "record at " + std::to_string(record.begin) + ", byte " +
                                            std::to_string(byte) + ", bit " + std::to_string(bit));
    }
  }
}

}  // namespace
}  // namespace stillhand::recording
