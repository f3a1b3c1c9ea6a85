// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/staged_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <stdexcept>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::report::staged_folder_test {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class StagedFolderTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path out() const { return folder_.path() / "out"; }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    return recording::read_file((out() / name).string());
  }
  static std::size_t entries(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }

  test::TemporaryFolder folder_;
};

TEST_F(StagedFolderTest, FilesAppearTogetherWhenTheyArePublished) {
  {
    StagedFolder sut(out());
    sut.write("a.txt", "one");
    sut.write("b.txt", "two");
    EXPECT_FALSE(fs::exists(out() / "a.txt"));
    EXPECT_EQ(sut.path().parent_path(), fs::canonical(out()));
    sut.publish({});
    EXPECT_EQ(text_of("a.txt"), "one");
  }
  EXPECT_EQ(text_of("b.txt"), "two");
  EXPECT_EQ(entries(out()), 2u) << "the hidden folder is gone";
}

TEST_F(StagedFolderTest, WithoutAPublicationEveryNewFolderIsRemovedAgain) {
  {
    StagedFolder sut(out() / "deep" / "deeper");
    sut.write("a.txt", "one");
    EXPECT_TRUE(fs::exists(out() / "deep" / "deeper"));
  }
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(StagedFolderTest, AFolderThatWasThereStaysAsItWas) {
  fs::create_directories(out());
  std::ofstream(out() / "a.txt") << "old";
  {
    StagedFolder sut(out() / "new");
    StagedFolder other(out());
    other.write("a.txt", "new");
  }
  EXPECT_EQ(text_of("a.txt"), "old");
  EXPECT_EQ(entries(out()), 1u);
}

TEST_F(StagedFolderTest, ANewFolderThatHoldsAForeignFileIsNotRemoved) {
  {
    StagedFolder sut(out());
    std::ofstream(out() / "foreign.txt") << "kept";
  }
  EXPECT_EQ(text_of("foreign.txt"), "kept");
  EXPECT_EQ(entries(out()), 1u);
}

TEST_F(StagedFolderTest, PublishReplacesFilesAndRemovesItsOwnOfAnEarlierRun) {
  fs::create_directories(out());
  for (const char* name : {"summary.json", "stale.png", "foreign.txt"}) {
    std::ofstream(out() / name) << "old";
  }
  fs::create_directories(out() / "folder.png");
  StagedFolder sut(out());
  sut.write("summary.json", "new");
  sut.publish({"summary.json", "stale.png", "never.png", "folder.png"});
  EXPECT_EQ(text_of("summary.json"), "new");
  EXPECT_EQ(text_of("foreign.txt"), "old");
  EXPECT_FALSE(fs::exists(out() / "stale.png"));
  EXPECT_TRUE(fs::is_directory(out() / "folder.png")) << "a folder is no result of a run";
}

TEST_F(StagedFolderTest, AFolderInThePlaceOfAFileIsRefusedBeforeAnyFileMoves) {
  fs::create_directories(out() / "b.txt");
  std::ofstream(out() / "stale.png") << "old";
  StagedFolder sut(out(), "--results");
  sut.write("a.txt", "one");
  sut.write("b.txt", "two");
  EXPECT_THAT([&] { sut.publish({"stale.png"}); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("--results"), HasSubstr("b.txt"))));
  EXPECT_FALSE(fs::exists(out() / "a.txt"));
  EXPECT_EQ(text_of("stale.png"), "old");
}

TEST_F(StagedFolderTest, ASecondRunInTheSameFolderIsRefusedAndLeavesTheFirstAlone) {
  std::optional<StagedFolder> first;
  first.emplace(out());
  first->write("a.txt", "one");
  EXPECT_THAT([&] { StagedFolder second(out(), "--csv"); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("--csv"), HasSubstr(out().string()))));
  EXPECT_TRUE(fs::exists(first->path() / "a.txt"));
  first->publish({});
  first.reset();
  EXPECT_EQ(text_of("a.txt"), "one");
  EXPECT_NO_THROW(StagedFolder third(out()));
}

TEST_F(StagedFolderTest, TheHiddenFolderOfAKilledRunIsRemoved) {
  fs::create_directories(out() / ".unfinished-abc");
  std::ofstream(out() / ".unfinished-abc" / "a.txt") << "half";
  {
    StagedFolder sut(out());
  }
  EXPECT_EQ(entries(out()), 0u);
}

TEST_F(StagedFolderTest, PlacesThatCannotBeFoldersAreRefusedWithTheOption) {
  std::ofstream(folder_.path() / "file") << "text";
  fs::create_symlink(folder_.path() / "nowhere", folder_.path() / "dangling");
  for (const fs::path& place :
       {fs::path(), folder_.path() / "file", folder_.path() / "file/below",
        folder_.path() / "dangling", fs::path("/dev/null"), fs::path("/proc/none/here")}) {
    EXPECT_THAT([&] { StagedFolder sut(place, "--results"); },
                ThrowsMessage<ConfigError>(HasSubstr("--results: got ")))
        << place;
  }
  EXPECT_EQ(folder_.entries(), 2u);
}

TEST_F(StagedFolderTest, ASlashAtTheEndAndDotsNameTheSameFolder) {
  {
    StagedFolder sut(folder_.path() / "x" / ".." / "out" / "");
    sut.write("a.txt", "one");
    sut.publish({});
  }
  EXPECT_EQ(text_of("a.txt"), "one");
}

TEST_F(StagedFolderTest, AFileThatCannotBeWrittenIsNamedAtItsPlace) {
  const StagedFolder sut(out());
  EXPECT_THAT([&] { sut.write("missing/a.txt", "one"); },
              ThrowsMessage<std::runtime_error>(HasSubstr((out() / "missing/a.txt").string())));
}

}  // namespace stillhand::report::staged_folder_test
