// SPDX-License-Identifier: Apache-2.0
#include "services/files/recording/file_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>

#include "tests/support/folder.hpp"
#include "tests/support/recorded_file.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::recording::file_io_test {
namespace {

namespace fs = std::filesystem;
using support::refusal;
using testing::HasSubstr;

// A folder of its own, gone afterwards.
class FileIoTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::size_t file_count() const { return files_.entries(); }

  const support::Folder files_;
  const fs::path& folder_ = files_.path();
};

std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

TEST_F(FileIoTest, ARecordingGoesThroughAFile) {
  {
    FileSink sink(path("a.mcap"));
    McapWriter writer(sink);
    const auto channel = writer.add_channel("p", 0, "cdr");
    ASSERT_TRUE(writer.write(channel, 0, 1, 1, bytes("hello")).ok());
    ASSERT_TRUE(writer.close().ok());
    EXPECT_EQ(sink.size(), fs::file_size(path("a.mcap")));
  }
  FileSource source(path("a.mcap"));
  McapReader reader(source);
  ASSERT_EQ(tests::messages_of(reader).size(), 1u);
}

TEST_F(FileIoTest, ARecordingIsNotOverwrittenUnlessWanted) {
  {
    FileSink first(path("a"));
  }
  EXPECT_THAT(refusal([&] { FileSink sut(path("a")); }), HasSubstr("File exists"));
  EXPECT_EQ(refusal([&] { FileSink sut(path("a"), Existing::kReplace); }), "accepted");
}

TEST_F(FileIoTest, FilesThatCannotBeOpenedAreNamed) {
  EXPECT_THAT(refusal([&] { FileSink sut(path("none/a")); }), HasSubstr("none/a: got No such"));
  EXPECT_THAT(refusal([&] { FileSource sut(path("none")); }), HasSubstr("none: got No such file"));
  EXPECT_THAT(refusal([&] { FileSource sut(folder_.string()); }), HasSubstr("not a regular file"));
}

TEST_F(FileIoTest, AFullDeviceIsAStatusWithItsReason) {
  FileSink sut("/dev/full", Existing::kReplace);
  const Status status = sut.write(bytes("x"));
  EXPECT_EQ(status.kind, StatusKind::kNoSpace);
  EXPECT_THAT(status.text, HasSubstr("/dev/full: cannot write: No space left"));
}

TEST_F(FileIoTest, WhatFitsBeforeTheDiskIsFullIsRecovered) {
  // A file size limit plays the full disk: the system then cuts a write short, like a disk does.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{10'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  Status status;
  std::uint64_t size = 0;
  {
    FileSink sink(path("a.mcap"));
    McapWriter writer(sink, {2000, Compression::kNone});
    const auto channel = writer.add_channel("p", 0, "cdr");
    const std::array<std::byte, 100> message{};
    for (std::uint32_t n = 0; n < 1000 && status.ok(); ++n) {
      status = writer.write(channel, n, n, n, message);
    }
    size = sink.size();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(status.kind, StatusKind::kNoSpace) << status.text;
  EXPECT_EQ(size, 10'000u);
  FileSource source(path("a.mcap"));
  McapReader reader(source);
  // 16 messages of 131 bytes fill a chunk; a chunk with its index takes about 2.4 kB.
  EXPECT_EQ(tests::messages_of(reader).size(), 4u * 16u);
  EXPECT_GT(reader.lost_bytes(), 0u);
}

TEST_F(FileIoTest, ReadingBeyondTheEndIsAStatus) {
  {
    ASSERT_TRUE(write_file_atomically(path("a"), "123").ok());
  }
  FileSource sut(path("a"));
  std::array<std::byte, 4> into{};
  EXPECT_EQ(sut.read_at(0, into).kind, StatusKind::kIo);
}

TEST_F(FileIoTest, AtomicWriteReplacesAndLeavesNothingElse) {
  ASSERT_TRUE(write_file_atomically(path("a"), "old").ok());
  ASSERT_TRUE(write_file_atomically(path("a"), "new").ok());
  EXPECT_EQ(read_file(path("a")), "new");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(FileIoTest, AFailedAtomicWriteKeepsTheOldFile) {
  fs::create_directory(path("a"));  // a folder cannot be replaced by a file
  const Status status = write_file_atomically(path("a"), "new");
  EXPECT_EQ(status.kind, StatusKind::kIo);
  EXPECT_THAT(status.text, HasSubstr("cannot replace"));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(FileIoTest, CsvComesFromAFileAndErrorsNameIt) {
  ASSERT_TRUE(write_file_atomically(path("a.csv"), "t [s],f [N]\n0,1\n0.01,2\n").ok());
  EXPECT_EQ(read_csv(path("a.csv")).find("f")->values, (std::vector<double>{1.0, 2.0}));
  ASSERT_TRUE(write_file_atomically(path("b.csv"), "t [s],f [N]\n0,x\n").ok());
  EXPECT_THAT(refusal([&] { (void)read_csv(path("b.csv")); }), HasSubstr("b.csv:2:3: got 'x'"));
}

}  // namespace
}  // namespace stillhand::recording::file_io_test
