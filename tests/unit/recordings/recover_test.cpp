// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/recover.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <stdexcept>

#include "tests/support/recorded_file.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::recover_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::vector<tests::PlainMessage> messages_in(const std::string& file) {
  OpenRecording recording(file);
  return tests::messages_of(recording.reader);
}

class RecoverTest : public FolderTest {
 protected:
  // A recording that a crash cut off in its last chunk, and its bytes.
  std::string cut_sample() {
    write_sample(path("a.mcap"), false);
    fs::resize_file(path("a.mcap"), fs::file_size(path("a.mcap")) - 600);
    return recording::read_file(path("a.mcap"));
  }
};

TEST_F(RecoverTest, TheWholeFileTakesTheNameAndTheOldOneIsKept) {
  const std::string before = cut_sample();
  const auto readable = messages_in(path("a.mcap"));
  const Recovered sut = recover(path("a.mcap"), {});
  EXPECT_EQ(sut.messages, readable.size());
  EXPECT_GT(sut.lost_bytes, 0u);
  EXPECT_EQ(recording::read_file(sut.kept), before);
  EXPECT_EQ(messages_in(path("a.mcap")), readable);
  OpenRecording mended(path("a.mcap"));
  EXPECT_TRUE(mended.reader.indexed());
  ASSERT_TRUE(mended.reader.verify().ok());
  EXPECT_TRUE(mended.reader.damage().empty());
  EXPECT_EQ(mended.reader.schemas().size(), 2u);
  EXPECT_EQ(mended.reader.find_metadata("stillhand.session")->texts.at("seed"), "7");
  const auto& told = mended.reader.find_metadata("stillhand.recovery")->texts;
  EXPECT_EQ(told.at("lost_bytes"), std::to_string(sut.lost_bytes));
  EXPECT_EQ(told.at("from"), "a.mcap");
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(RecoverTest, WithOutTheOldFileStaysAsItIs) {
  const std::string before = cut_sample();
  const Recovered sut = recover(path("a.mcap"), {path("b.mcap"), recording::Compression::kLz4});
  EXPECT_EQ(sut.out, path("b.mcap"));
  EXPECT_EQ(sut.kept, "");
  EXPECT_EQ(recording::read_file(path("a.mcap")), before);
  EXPECT_EQ(messages_in(path("b.mcap")), messages_in(path("a.mcap")));
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(RecoverTest, AWholeFileIsLeftAlone) {
  write_sample(path("a.mcap"));
  const auto changed = fs::last_write_time(path("a.mcap"));
  const Recovered sut = recover(path("a.mcap"), {});
  EXPECT_TRUE(sut.was_whole);
  EXPECT_EQ(fs::last_write_time(path("a.mcap")), changed);
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(RecoverTest, ADamagedChunkIsLostAloneAndNamed) {
  write_sample(path("a.mcap"));
  std::string bytes = recording::read_file(path("a.mcap"));
  const auto whole = messages_in(path("a.mcap"));
  const std::string zstd_frame("\x28\xb5\x2f\xfd");  // RFC 8878, 3.1.1
  const std::size_t second_chunk = bytes.find(zstd_frame, bytes.find(zstd_frame) + 1);
  ASSERT_NE(second_chunk, std::string::npos);
  bytes[second_chunk + 40] ^= 1;
  ASSERT_TRUE(recording::write_file_atomically(path("a.mcap"), bytes).ok());
  const Recovered sut = recover(path("a.mcap"), {});
  EXPECT_LT(sut.messages, whole.size());
  EXPECT_GE(sut.messages, whole.size() - 30);  // a chunk of 1 kB holds 10 of them
  EXPECT_THAT(sut.findings, testing::Contains(HasSubstr("chunk lost")));
}

TEST_F(RecoverTest, WhereNothingCanBeReadNothingIsWritten) {
  const std::string magic("\x89MCAP0\r\n");
  for (const std::string& bytes : {magic, magic + magic, magic + std::string(5000, '\0')}) {
    ASSERT_TRUE(recording::write_file_atomically(path("a.mcap"), bytes).ok());
    for (const std::string& out : {path("b.mcap"), std::string()}) {
      EXPECT_THAT([&] { recover(path("a.mcap"), {out}); },
                  testing::ThrowsMessage<std::runtime_error>(
                      HasSubstr("a.mcap: no message and no metadata can be read")));
      EXPECT_EQ(recording::read_file(path("a.mcap")), bytes);
      EXPECT_EQ(file_count(), 1u);
    }
  }
}

// Killed before its first message: what is known of the session is kept.
TEST_F(RecoverTest, MetadataAloneIsRecovered) {
  {
    recording::FileSink sink(path("a.mcap"));
    recording::McapWriter writer(sink);
    ASSERT_TRUE(writer.add_metadata("stillhand.session", {{"seed", "7"}}).ok());
    ASSERT_TRUE(writer.flush_chunk().ok());
  }
  EXPECT_EQ(recover(path("a.mcap"), {}).messages, 0u);
  OpenRecording mended(path("a.mcap"));
  EXPECT_NE(mended.reader.find_metadata("stillhand.session"), nullptr);
}

TEST_F(RecoverTest, NoFileIsWrittenOver) {
  const std::string before = cut_sample();
  for (const char* name : {"taken", "a.mcap.damaged"}) {
    ASSERT_TRUE(recording::write_file_atomically(path(name), "kept").ok());
  }
  EXPECT_THAT(support::refusal([&] { recover(path("a.mcap"), {path("taken")}); }),
              HasSubstr("taken: got a file that exists, want a name that does not exist"));
  EXPECT_THAT(support::refusal([&] { recover(path("a.mcap"), {}); }),
              HasSubstr("a.mcap.damaged: got a file that exists"));
  EXPECT_EQ(recording::read_file(path("a.mcap")), before);
  EXPECT_EQ(recording::read_file(path("taken")), "kept");
  EXPECT_EQ(file_count(), 3u);
}

TEST_F(RecoverTest, AFileThatIsStillBeingWrittenIsRefused) {
  recording::FileSink sink(path("a.mcap"));
  recording::McapWriter writer(sink);
  const auto channel = writer.add_channel("p", 0, "cdr");
  ASSERT_TRUE(writer.write(channel, 0, 1, 1, std::vector<std::byte>(9)).ok());
  ASSERT_TRUE(writer.flush_chunk().ok());
  EXPECT_THAT(support::refusal([&] { recover(path("a.mcap"), {}); }),
              HasSubstr("a.mcap: got a file that is still being written, want one whose recorder"));
  EXPECT_EQ(file_count(), 1u);
}

// Ctrl-C at every moment at which it is asked for.
TEST_F(RecoverTest, GivenUpAtAnyMomentItLeavesTheOldFileAlone) {
  const std::string before = cut_sample();
  bool whole = false;
  for (int moment = 0; !whole; ++moment) {
    RecoverOptions options;
    int asked = 0;
    options.stopped = [&] { return asked++ == moment; };
    try {
      recover(path("a.mcap"), options);
      whole = true;
      EXPECT_EQ(asked, moment);
    } catch (const Interrupted&) {
      ASSERT_EQ(file_count(), 1u) << moment;
      ASSERT_EQ(recording::read_file(path("a.mcap")), before) << moment;
    }
  }
  EXPECT_EQ(file_count(), 2u);
}

// The full disk, as a bound on the size of files: the old file stays, no half file is left.
TEST_F(RecoverTest, AFullDiskCostsNothing) {
  const std::string before = cut_sample();
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit small{4096, old.rlim_max};
  const auto disposition = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THAT([&] { recover(path("a.mcap"), {}); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("cannot write")));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, disposition);
  EXPECT_EQ(recording::read_file(path("a.mcap")), before);
  EXPECT_EQ(file_count(), 1u);
}

}  // namespace
}  // namespace stillhand::recordings::recover_test
