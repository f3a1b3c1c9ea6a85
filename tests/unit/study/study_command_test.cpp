// SPDX-License-Identifier: Apache-2.0
// Options of the verb that are refused, and that nothing is left where the output would be.
#include "apps/study/study_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/verb.hpp"

namespace stillhand::study::study_command_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class StudyCommandTest : public testing::Test {
 protected:
  void run(std::vector<std::string> words) const {
    words.insert(words.end(), {"--out", (folder_ / "study").string()});
    support::run_verb(add_study_command, support::named("study", std::move(words)));
  }
  [[nodiscard]] std::string message_of(const std::vector<std::string>& words) const {
    return support::refusal([&] { run(words); });
  }
  [[nodiscard]] std::string population(const std::string& yaml) const {
    const fs::path file = folder_ / "people.yaml";
    std::ofstream(file) << yaml;
    return file.string();
  }

  const support::Folder folder_;
};

TEST_F(StudyCommandTest, AValueOutOfAnOptionsRangeIsAUsageError) {
  using Words = std::vector<std::string>;
  for (const Words& words :
       {Words{"--seed", "-1"}, Words{"--seed", "9223372036854775808"}, Words{"--seed", "one"},
        Words{"--population", ""}, Words{"--stick-damping", "49.1"},
        Words{"--stick-damping", "-0.1"}, Words{"--stick-damping", "nan"},
        Words{"--threads", "257"}, Words{"--threads", "-1"}, Words{"--subjects", "twelve"},
        Words{"--trial-seconds", "3 minutes"}, Words{"--undeclared-effect", "-1"},
        Words{"--no-such-option"}, Words{"stray"}}) {
    EXPECT_THROW(run(words), command_line::UsageError) << words.front() << " " << words.back();
  }
  EXPECT_FALSE(fs::exists(folder_ / "study"));
}

TEST_F(StudyCommandTest, AConditionThatThereIsNotIsRefusedWithTheOnesThereAre) {
  EXPECT_THAT(message_of({"--conditions", "A,G"}),
              AllOf(StartsWith("--conditions: got \"G\""), HasSubstr("arm rest")));
  EXPECT_FALSE(fs::exists(folder_ / "study"));
}

TEST_F(StudyCommandTest, APopulationThatIsWrongIsRefusedWithItsPlace) {
  EXPECT_THAT(message_of({"--population", population("delay_s: 0.2\ngrip_cv: 0.1\n")}),
              HasSubstr("people.yaml:2:1: population.grip_cv: got "));
  EXPECT_THAT(message_of({"--population", population("delay_s: 0.1\n")}),
              HasSubstr("people.yaml:1:10: population.delay_s: got 0.1, want "));
  EXPECT_THAT(message_of({"--population", (folder_ / "absent.yaml").string()}),
              HasSubstr("absent.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "study"));
}

TEST_F(StudyCommandTest, ARefusedStudyLeavesNoFolder) {
  using Words = std::vector<std::string>;
  const std::vector<std::pair<Words, const char*>> cases{
      {{"--subjects", "0"}, "--subjects: got 0"},
      {{"--subjects", "10001"}, "--subjects: got 10001"},
      {{"--subjects", "1", "--wrong-models"}, "--wrong-models: got "},
      {{"--trial-seconds", "4.9"}, "--trial-seconds: got 4.9"},
      {{"--trial-seconds", "nan"}, "--trial-seconds: got nan"},
      {{"--identify-seconds", "3601"}, "--identify-seconds: got 3601"}};
  for (const auto& [words, want] : cases) {
    EXPECT_THAT(message_of(words), StartsWith(want));
    EXPECT_FALSE(fs::exists(folder_ / "study")) << want;
  }
}

TEST_F(StudyCommandTest, AnEarlierStudyStaysWhenTheNextOneIsRefused) {
  fs::create_directories(folder_ / "study");
  std::ofstream(folder_ / "study" / "summary.json") << "earlier";
  EXPECT_THAT(message_of({"--subjects", "0"}), StartsWith("--subjects: got 0"));
  std::string text;
  std::getline(std::ifstream(folder_ / "study" / "summary.json"), text);
  EXPECT_EQ(text, "earlier");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "study"), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace stillhand::study::study_command_test
