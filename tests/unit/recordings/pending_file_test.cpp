// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/pending_file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/support/refusal.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::pending_file_test {
namespace {

using testing::HasSubstr;

class PendingFileTest : public FolderTest {
 protected:
  static void write(const std::string& file, const std::string& text) {
    std::ofstream(file) << text;
  }
};

TEST_F(PendingFileTest, TheFileAppearsWhenItIsPublishedAndReplacesTheOldOne) {
  write(path("a.mat"), "old");
  {
    PendingFile sut(path("a.mat"));
    write(sut.path(), "new");
    EXPECT_EQ(recording::read_file(path("a.mat")), "old");
    sut.publish();
    EXPECT_EQ(recording::read_file(path("a.mat")), "new");
  }
  EXPECT_EQ(recording::read_file(path("a.mat")), "new");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(PendingFileTest, WithoutAPublicationNothingIsLeft) {
  {
    PendingFile sut(path("a.mat"));
    write(sut.path(), "half");
    EXPECT_EQ(file_count(), 1u);
  }
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(PendingFileTest, PublishNewTakesAFreeNameAlone) {
  {
    PendingFile sut(path("a.mcap"));
    write(sut.path(), "new");
    sut.publish_new();
    EXPECT_EQ(recording::read_file(path("a.mcap")), "new");
  }
  EXPECT_EQ(file_count(), 1u);
  PendingFile second(path("a.mcap"));
  write(second.path(), "newer");
  EXPECT_THAT(support::refusal([&] { second.publish_new(); }), HasSubstr("a.mcap: got "));
  EXPECT_EQ(recording::read_file(path("a.mcap")), "new");
}

TEST_F(PendingFileTest, ANameThatIsTakenMeanwhileIsNotWrittenOver) {
  PendingFile sut(path("a.mcap"));
  write(sut.path(), "new");
  write(path("a.mcap"), "of somebody else");
  EXPECT_THAT(support::refusal([&] { sut.publish_new(); }), HasSubstr("a.mcap: got "));
  EXPECT_EQ(recording::read_file(path("a.mcap")), "of somebody else");
}

TEST_F(PendingFileTest, ADeviceAFolderAndALinkToOneAreRefused) {
  std::filesystem::create_directories(path("folder"));
  std::filesystem::create_symlink("/dev/null", path("link"));
  for (const std::string& place : {std::string("/dev/null"), path("folder"), path("link")}) {
    EXPECT_THAT(support::refusal([&] { PendingFile sut(place); }), HasSubstr(place + ": got "));
  }
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(PendingFileTest, AFileThatWasNeverWrittenOrLostItsFolderIsARunTimeError) {
  PendingFile sut(path("a.mat"));
  EXPECT_THAT([&] { sut.publish(); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("a.mat")));
  std::filesystem::create_directory(path("none"));
  PendingFile lost(path("none/a.mat"));
  std::filesystem::remove(path("none"));
  EXPECT_THAT([&] { lost.publish_new(); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("none/a.mat")));
  EXPECT_EQ(
      support::refusal([&] { PendingFile(path("none/a.mat")); }),
      path("none/a.mat") +
          ": got a name in a folder that does not exist, want a name in a folder that exists");
  EXPECT_EQ(file_count(), 0u);
}

}  // namespace
}  // namespace stillhand::recordings::pending_file_test
