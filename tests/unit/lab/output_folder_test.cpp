// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/output_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::lab::output_folder_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using Path = std::filesystem::path;

class OutputFolderTest : public testing::Test {
 protected:
  void write(const Path& name) const {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "x";
  }
  // Names below the folder.
  [[nodiscard]] std::set<std::string> content() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      names.insert(entry.path().lexically_relative(folder).string());
    }
    return names;
  }
  [[nodiscard]] std::string refusal(const Path& ride = {}) const {
    return support::refusal([&] { const OutputFolder sut(folder, {ride}); });
  }

  const support::Folder around;
  Path folder = around / "out";
};

TEST_F(OutputFolderTest, IsMadeAndGoesAgainWithASessionThatNeverWas) {
  {
    OutputFolder sut(folder, {});
    EXPECT_THAT(content(), ElementsAre("logs"));
    write("logs/rig.log");
    sut.discard();
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST_F(OutputFolderTest, AnEarlierSessionsResultsAreMovedAndKeptAndNothingElse) {
  for (const char* name : {"session.mcap", "summary.json", "model.json", "screen.avi", "notes.txt",
                           "logs/rig.log", "logs/mine.log"}) {
    write(name);
  }
  {
    const OutputFolder sut(folder, {});
    for (const char* name : {"session.mcap", "summary.json", "model.json", "logs/rig.log"}) {
      EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
    }
    EXPECT_TRUE(std::filesystem::exists(folder / "notes.txt"));
    write("session.mcap");
  }
  EXPECT_THAT(content(), ElementsAre("earlier-1", "earlier-1/logs", "earlier-1/logs/rig.log",
                                     "earlier-1/model.json", "earlier-1/screen.avi",
                                     "earlier-1/session.mcap", "earlier-1/summary.json", "logs",
                                     "logs/mine.log", "notes.txt", "session.mcap"));
}

TEST_F(OutputFolderTest, EachEarlierSessionIsKeptInAFolderOfItsOwn) {
  for (int i = 0; i < 3; ++i) {
    const OutputFolder sut(folder, {});
    write("session.mcap");
  }
  EXPECT_THAT(content(), ElementsAre("earlier-1", "earlier-1/session.mcap", "earlier-2",
                                     "earlier-2/session.mcap", "logs", "session.mcap"));
}

TEST_F(OutputFolderTest, ASessionThatNeverBeganGivesTheEarlierOnesFilesBack) {
  for (const char* name : {"session.mcap", "summary.json", "logs/rig.log"}) write(name);
  const auto before = content();
  OutputFolder sut(folder, {});
  write("session.mcap");
  write("report.html");
  sut.discard();
  EXPECT_EQ(content(), before);
}

TEST_F(OutputFolderTest, AfterALabThatWasKilledTheNextOneFindsTheEarlierFiles) {
  write(".earlier-session/session.mcap");
  write(".earlier-session/logs/rig.log");
  OutputFolder sut(folder, {});
  sut.discard();
  EXPECT_THAT(content(), ElementsAre("logs", "logs/rig.log", "session.mcap"));
}

TEST_F(OutputFolderTest, TheRideOfThisSessionIsNotReplaced) {
  write("session.mcap");
  EXPECT_THAT(refusal(folder / "session.mcap"),
              AllOf(StartsWith("--out: got "), HasSubstr("session.mcap is read by this session")));
  // By another name too.
  std::filesystem::create_symlink(folder / "session.mcap", folder / "ride.mcap");
  EXPECT_THAT(refusal(folder / "ride.mcap"), HasSubstr("session.mcap is read by this session"));
  EXPECT_THAT(content(), ElementsAre("ride.mcap", "session.mcap"));
}

TEST_F(OutputFolderTest, ARideBesideTheResultsIsKept) {
  write("ride.csv");
  EXPECT_EQ(refusal(folder / "ride.csv"), "accepted");
  EXPECT_TRUE(std::filesystem::exists(folder / "ride.csv"));
}

TEST_F(OutputFolderTest, ASecondLabIsRefusedAndTheFirstKeepsItsFiles) {
  const OutputFolder first(folder, {});
  write("session.mcap");
  EXPECT_THAT(refusal(), HasSubstr("where another lab writes"));
  EXPECT_THAT(content(), ElementsAre("logs", "session.mcap"));
}

TEST_F(OutputFolderTest, IsFreeAgainAfterwards) {
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(OutputFolderTest, WhatIsInTheWayIsNamed) {
  write("session.mcap/kept");
  EXPECT_THAT(refusal(), HasSubstr("session.mcap, which is in the way"));
  EXPECT_TRUE(std::filesystem::exists(folder / "session.mcap" / "kept"));
  std::filesystem::remove_all(folder);
  write("logs");
  EXPECT_THAT(refusal(), HasSubstr("logs is no folder"));
}

// A link may lead to a file of another program: the link goes, its target stays.
TEST_F(OutputFolderTest, ALinkAmongTheResultsIsRemovedAndItsTargetIsKept) {
  write("kept.txt");
  std::filesystem::create_symlink(folder / "kept.txt", folder / "summary.json");
  std::filesystem::create_symlink(folder / "kept.txt", folder / ".stillhand-probe");
  std::filesystem::create_symlink(folder / "nowhere", folder / "model.json");
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_THAT(content(), ElementsAre("kept.txt", "logs"));
  std::string text;
  std::ifstream(folder / "kept.txt") >> text;
  EXPECT_EQ(text, "x");
}

TEST_F(OutputFolderTest, TheFilesOfASessionOverSeveralMachinesAreMoved) {
  for (const char* name : {"logs/profiles.xml", "logs/host_rig-pc.log", "logs/host_notes.txt",
                           "logs/ghost_rig-pc.log", "verdict.json", "report.html"}) {
    write(name);
  }
  {
    const OutputFolder sut(folder, {});
  }
  EXPECT_THAT(
      content(),
      ElementsAre("earlier-1", "earlier-1/logs", "earlier-1/logs/host_rig-pc.log",
                  "earlier-1/logs/profiles.xml", "earlier-1/report.html", "earlier-1/verdict.json",
                  "logs", "logs/ghost_rig-pc.log", "logs/host_notes.txt"));
}

TEST_F(OutputFolderTest, AFolderThatWasThereStaysWhenTheSessionIsDiscarded) {
  std::filesystem::create_directories(folder);
  {
    OutputFolder sut(folder, {});
    write("session.mcap");
    sut.discard();
  }
  EXPECT_TRUE(std::filesystem::is_directory(folder));
  EXPECT_THAT(content(), IsEmpty());
}

TEST_F(OutputFolderTest, AFileInThePlaceOfTheFolderAndAnEmptyNameAreRefused) {
  std::ofstream(folder.string()) << "x";
  EXPECT_THAT(refusal(), AllOf(StartsWith("--out: got "), HasSubstr(folder.string())));
  EXPECT_TRUE(std::filesystem::is_regular_file(folder));
  EXPECT_THAT(support::refusal([&] { const OutputFolder sut("", {}); }), StartsWith("--out: "));
}

}  // namespace
}  // namespace stillhand::lab::output_folder_test
