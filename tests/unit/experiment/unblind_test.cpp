// SPDX-License-Identifier: Apache-2.0
// Three participants: P01 is complete, P02 has two of three trials, P03 has not begun.
#include "apps/experiment/unblind.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/experiment/status.hpp"
#include "apps/libraries/experiment/file/standing.hpp"
#include "services/files/recording/file_io.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::experiment::unblind_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;

class UnblindTest : public testing::Test {
 protected:
  UnblindTest() {
    Design design;
    design.participants = 3;
    make_folder(place_ / "study1", design, 11);
    conduct(0, 3);
    conduct(1, 2);
  }

  void conduct(std::size_t index, std::size_t trials) {
    std::filesystem::create_directories(folder().participant(index));
    Journal journal(folder().journal(index));
    journal.append({.kind = EntryKind::kSessionBegan, .session = 1});
    for (std::size_t step = 0; step < trials; ++step) {
      journal.append({.kind = EntryKind::kTrialEnded,
                      .session = 1,
                      .step = static_cast<std::int64_t>(step),
                      .completed = true});
    }
  }
  void exclude(std::size_t index) {
    Journal(folder().journal(index)).append({.kind = EntryKind::kExcluded, .text = "felt sick"});
  }
  [[nodiscard]] Folder folder() const { return Folder(place_ / "study1"); }
  nlohmann::json opened(const Unblinding& asked, const std::string& typed = "") const {
    std::istringstream line(typed);
    return nlohmann::json::parse(unblind(folder(), asked, line));
  }
  [[nodiscard]] std::string refusal(const Unblinding& asked, const std::string& typed = "") const {
    const std::string said = support::refusal([&] { static_cast<void>(opened(asked, typed)); });
    EXPECT_FALSE(folder().unblinded());
    EXPECT_FALSE(std::filesystem::exists(folder().path() / "journal.jsonl"));
    return said;
  }

  const support::Folder place_;
};

TEST_F(UnblindTest, AnIncompleteExperimentStaysBlindedAndWhoIsMissingIsNamed) {
  EXPECT_THAT(refusal({.reason = "curious"}),
              AllOf(HasSubstr("2 of 3 participants not complete: P02 (2 of 3 trials), P03 (not "
                              "begun)"),
                    HasSubstr("--incomplete"), Not(HasSubstr("\n"))));
}

TEST_F(UnblindTest, IncompleteNeedsTheNameOfTheExperimentOnStandardInput) {
  const Unblinding asked{.reason = "the grant ends", .incomplete = true};
  EXPECT_THAT(refusal(asked), HasSubstr("no line on standard input"));
  EXPECT_THAT(refusal(asked, "yes\n"), HasSubstr("got yes, want study1"));
  EXPECT_EQ(opened(asked, "study1\n")["orders"].size(), 3u);
  EXPECT_TRUE(folder().unblinded());
}

TEST_F(UnblindTest, ReasonTimeAndNumberOfCompleteParticipantsAreInTheJournal) {
  opened({.reason = "the grant ends", .incomplete = true}, "study1");
  const Standing sut = standing_of(folder().path(), folder().design());
  ASSERT_EQ(sut.openings.size(), 1u);
  EXPECT_EQ(sut.openings[0].text, "the grant ends");
  EXPECT_EQ(sut.openings[0].complete, 1);
  EXPECT_THAT(in_words(sut.openings[0], sut.planned()),
              AllOf(HasSubstr("All conditions were unblinded at " + sut.openings[0].time),
                    HasSubstr("with 1 of 3 participants complete: the grant ends.")));
}

TEST_F(UnblindTest, OnePersonIsOpenedAloneAndTheOthersStayBlinded) {
  const auto shown = opened({.reason = "fainted", .participant = "P02"});
  EXPECT_EQ(shown["labels"].size(), 1u);
  EXPECT_EQ(shown["orders"]["P02"].size(), 3u);
  EXPECT_FALSE(folder().unblinded());
  EXPECT_TRUE(std::filesystem::exists(folder().participant(1) / "assignment.json"));
  EXPECT_THAT(overview_of(folder()).table,
              AllOf(HasSubstr("conditions: blinded"), HasSubstr("P02 alone was unblinded"),
                    HasSubstr("fainted")));
}

TEST_F(UnblindTest, OnePersonWithoutASessionIsRefused) {
  EXPECT_THAT(refusal({.reason = "curious", .participant = "P03"}), HasSubstr("no session"));
}

TEST_F(UnblindTest, WhoIsExcludedIsNotWaitedFor) {
  conduct(2, 3);
  exclude(1);
  EXPECT_EQ(opened({.reason = "the end"})["labels"].size(), 3u);
}

TEST_F(UnblindTest, TheStandingNamesEveryPlannedParticipant) {
  exclude(1);
  const Standing sut = standing_of(folder().path(), folder().design());
  EXPECT_THAT(sut.complete, ElementsAre("P01"));
  EXPECT_THAT(sut.excluded, ElementsAre(Pair("P02", "felt sick")));
  EXPECT_THAT(sut.incomplete, ElementsAre(Pair("P03", "not begun")));
  EXPECT_EQ(in_words(sut),
            "1 of 3 participants complete; 1 excluded: P02 (felt sick); 1 not complete: P03 (not "
            "begun).");
}

TEST_F(UnblindTest, TheStatusListsWhoHasNotBegun) {
  EXPECT_THAT(overview_of(folder()).table, testing::ContainsRegex("P03 .* 0/3 .*not begun"));
}

TEST_F(UnblindTest, TheNoteOfAnOlderVersionIsAnOpening) {
  const auto entries =
      entries_of("{\"time\":\"t\",\"what\":\"note\",\"text\":\"unblinded: the end\"}\n", "j");
  EXPECT_EQ(entries.at(0).kind, EntryKind::kUnblinded);
  EXPECT_EQ(in_words(entries.at(0), 3), "All conditions were unblinded at t: the end.");
}

}  // namespace
}  // namespace stillhand::experiment::unblind_test
