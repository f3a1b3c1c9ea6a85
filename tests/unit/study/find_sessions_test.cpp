// SPDX-License-Identifier: Apache-2.0
// Whose a recording is, in made folders.
#include "apps/study/recorded/find_sessions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::study::find_sessions_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FindSessionsTest : public testing::Test {
 protected:
  // An MCAP file without messages, in a folder of its own.
  [[nodiscard]] fs::path session(const std::string& name, const recording::TextMap& texts) const {
    const fs::path at = folder_ / name;
    fs::create_directories(at);
    recording::FileSink sink((at / "session.mcap").string());
    recording::McapWriter writer(sink);
    if (!texts.empty()) {
      EXPECT_TRUE(writer.add_metadata("stillhand.experiment", texts).ok());
    }
    EXPECT_TRUE(writer.close().ok());
    return at;
  }
  [[nodiscard]] static recording::TextMap of(const std::string& participant,
                                             const std::string& session,
                                             const std::string& digest = "d1") {
    return {{"participant", participant}, {"session", session}, {"digest", digest}};
  }
  [[nodiscard]] static std::string refusal(const std::vector<fs::path>& folders) {
    return support::refusal([&] { find_sessions(folders); });
  }

  const support::Folder made_;
  const fs::path& folder_ = made_.path();
};

TEST_F(FindSessionsTest, ASessionWithoutAnExperimentHasTheNameOfItsFolder) {
  const auto found = find_sessions({session("anna7", {}).string() + "/"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].participant, "anna7");
  EXPECT_EQ(found[0].digest, "");
}

TEST_F(FindSessionsTest, AFolderMayBeNamedFromTheCurrentOne) {
  (void)session("P01", {});
  (void)session("runs/P02", {});
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  const std::string said = refusal({"P01", "runs/P02"});
  fs::current_path(before);
  EXPECT_EQ(said, "accepted");
}

TEST_F(FindSessionsTest, AnExperimentGivesItsSessionsByParticipantThenSession) {
  (void)session("e/participants/P02/sessions/01", of("P02", "01"));
  (void)session("e/participants/P01/sessions/02", of("P01", "02"));
  (void)session("e/participants/P01/sessions/01", of("P01", "01"));
  const auto found = find_sessions({folder_ / "e"});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].participant + found[0].session, "P0101");
  EXPECT_EQ(found[1].participant + found[1].session, "P0102");
  EXPECT_EQ(found[2].participant + found[2].session, "P0201");
  EXPECT_EQ(found[2].digest, "d1");
}

TEST_F(FindSessionsTest, AnExperimentIsReadAfterItIsUnblinded) {
  (void)session("e/participants/P01/sessions/01", of("P01", "01"));
  std::ofstream(folder_ / "e" / "experiment.yaml") << "title: one\n";
  EXPECT_THAT(refusal({folder_ / "e"}), HasSubstr("an experiment that is still blinded"));
  std::ofstream(folder_ / "e" / "assignment.json") << "{}\n";
  EXPECT_EQ(find_sessions({folder_ / "e"}).size(), 1u);
}

TEST_F(FindSessionsTest, AnExcludedParticipantHasTheReasonOfTheJournal) {
  (void)session("e/participants/P01/sessions/01", of("P01", "01"));
  (void)session("e/participants/P02/sessions/01", of("P02", "01"));
  std::ofstream(folder_ / "e/participants/P02/journal.jsonl")
      << "{\"what\":\"session began\"}\n{\"what\":\"excluded\",\"text\":\"felt sick\"}\n"
         "{\"what\":7}\n[]\n{\"wh";
  const auto found = find_sessions({folder_ / "e"});
  EXPECT_EQ(found.at(0).excluded, "");
  EXPECT_EQ(found.at(1).excluded, "felt sick");
}

TEST_F(FindSessionsTest, TheRecordingStatesItsParticipantOutsideTheExperimentToo) {
  const auto found = find_sessions({session("moved", of("P05", "03"))});
  EXPECT_EQ(found.at(0).participant + found.at(0).session, "P0503");
}

TEST_F(FindSessionsTest, WrongFoldersAreNamed) {
  const fs::path one = session("one", of("P01", "01"));
  EXPECT_THAT(refusal({folder_ / "nothing"}), HasSubstr("without session.mcap"));
  EXPECT_THAT(refusal({one, session("two", of("P01", "01"))}),
              HasSubstr("participant P01, session 01, as in"));
  EXPECT_THAT(refusal({one, session("three", of("P02", "01", "d2"))}),
              HasSubstr("another experiment"));
  EXPECT_THAT(refusal({session("four", {{"participant", "P04"}})}), HasSubstr("without its keys"));
  (void)session("e/participants/P02/sessions/01", of("P03", "01"));
  EXPECT_THAT(refusal({folder_ / "e"}), HasSubstr("a recording of participant P03"));
  std::ofstream(one / "session.mcap", std::ios::trunc) << "no MCAP";
  EXPECT_THAT(refusal({one}), HasSubstr("an MCAP recording of a session"));
}

}  // namespace
}  // namespace stillhand::study::find_sessions_test
