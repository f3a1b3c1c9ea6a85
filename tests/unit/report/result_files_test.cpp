// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/result_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::report::result_files_test {

namespace fs = std::filesystem;
using support::text_of;
using testing::HasSubstr;

class ResultFilesTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      out.push_back(entry.path().filename());
    }
    return out;
  }
  static std::string error_of(const std::vector<ResultFile>& files,
                              const std::vector<fs::path>& inputs = {}) {
    return support::refusal([&] { const ResultFiles sut(files, inputs); });
  }

  const support::Folder folder_;
};

TEST_F(ResultFilesTest, FilesAppearWhenTheyArePublishedAndNotBefore) {
  ResultFiles sut({{"--save", at("a")}, {"--json", at("b")}}, {});
  sut.set("--save", "one");
  sut.set("--json", "two");
  EXPECT_TRUE(names().empty());
  sut.publish();
  EXPECT_EQ(text_of(at("a")), "one");
  EXPECT_EQ(text_of(at("b")), "two");
  EXPECT_EQ(names().size(), 2u);
}

TEST_F(ResultFilesTest, OnlyWhatWasAskedForIsWanted) {
  const ResultFiles sut({{"--save", ""}, {"--json", at("b")}}, {});
  EXPECT_FALSE(sut.wants("--save"));
  EXPECT_TRUE(sut.wants("--json"));
}

TEST_F(ResultFilesTest, AnEarlierFileIsReplacedThroughItsLink) {
  std::ofstream(at("there")) << "earlier";
  fs::create_symlink(at("there"), at("link"));
  ResultFiles sut({{"--save", at("link")}}, {});
  sut.set("--save", "new");
  sut.publish();
  EXPECT_TRUE(fs::is_symlink(at("link")));
  EXPECT_EQ(text_of(at("there")), "new");
}

// The second can't be made any more: the first stays as it was.
TEST_F(ResultFilesTest, WhenOneCannotBeWrittenNoneIs) {
  std::ofstream(at("a")) << "earlier";
  fs::create_directory(at("gone"));
  ResultFiles sut({{"--save", at("a")}, {"--json", at("gone") / "b"}}, {});
  fs::remove(at("gone"));
  EXPECT_THROW(sut.publish(), std::runtime_error);
  EXPECT_EQ(text_of(at("a")), "earlier");
  EXPECT_THAT(names(), testing::ElementsAre("a"));
}

TEST_F(ResultFilesTest, ADeviceIsWrittenToAndStaysADevice) {
  ResultFiles sut({{"--save", "/dev/null"}, {"--json", "/dev/null"}}, {});
  sut.set("--save", "text");
  sut.publish();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(ResultFilesTest, PlacesThatCannotBeAreRefused) {
  EXPECT_THAT(error_of({{"--save", folder_.path()}}),
              HasSubstr("a folder, want the name of a file"));
  EXPECT_THAT(error_of({{"--save", at("no") / "a"}}), HasSubstr("a folder that exists"));
  EXPECT_THAT(error_of({{"--save", at("a")}, {"--json", folder_ / "." / "a"}}),
              HasSubstr("--json: got"));
}

TEST_F(ResultFilesTest, AnInputIsNotWrittenOver) {
  std::ofstream(at("ride.csv")) << "t [s]";
  fs::create_hard_link(at("ride.csv"), at("twin"));
  EXPECT_THAT(error_of({{"--save", at("ride.csv")}}, {at("ride.csv")}), HasSubstr("which is read"));
  EXPECT_THAT(error_of({{"--save", at("twin")}}, {at("ride.csv")}), HasSubstr("which is read"));
}

TEST_F(ResultFilesTest, ADashGetsTheResultAloneAndTheRestGoesToStandardError) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int own_stdout = dup(STDOUT_FILENO);
  {
    ResultFiles sut({{"--json", "-"}}, {});
    std::printf("a table\n");
    std::fflush(stdout);
    sut.set_json("--json", R"({"a": 1})");
    sut.publish();
  }
  dup2(own_stdout, STDOUT_FILENO);
  close(own_stdout);
  const std::string result = testing::internal::GetCapturedStdout();
  EXPECT_THAT(result, testing::StartsWith("{"));
  EXPECT_THAT(result, HasSubstr("\"provenance\""));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("a table"));
  EXPECT_THAT(error_of({{"--json", "-"}, {"--save", "-"}}), HasSubstr("one result"));
}

}  // namespace stillhand::report::result_files_test
