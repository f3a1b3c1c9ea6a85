// SPDX-License-Identifier: Apache-2.0
#include "services/system/command_line/command_line.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"

namespace stillhand::command_line::command_line_test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// A program with an option of each ready-made check.
struct Made {
  Program sut{"made for a test"};
  std::int64_t order = 4;
  std::string model = "auto";
  std::string file;
  std::vector<std::string> topics;

  Made() {
    sut.last_word_counts();
    sut.add_option("--order", order, "order of the model").between(1, 12);
    sut.add_option("--model", model, "model").one_of({"auto", "arx"});
    sut.add_option("--file", file, "file").existing_file();
    sut.add_option("--topics", topics, "pattern").repeatable();
  }

  // Why the words are refused.
  std::string refusal_of(const std::vector<std::string>& words) {
    return support::refusal<UsageError>([&] { sut.parse(words); });
  }
};

TEST(CommandLineTest, AWordThatAnOptionDoesNotTakeIsRefusedInOneSentence) {
  EXPECT_THAT(Made().refusal_of({"--order", "13"}), StartsWith("--order: Value 13 not in range"));
  EXPECT_THAT(Made().refusal_of({"--order", "0"}), StartsWith("--order: Value 0 not in range"));
  EXPECT_EQ(Made().refusal_of({"--model", "ar"}), "--model: ar not in {auto,arx}");
  EXPECT_EQ(Made().refusal_of({"--file", "/no/such"}), "--file: File does not exist: /no/such");
  EXPECT_EQ(Made().refusal_of({"--order", "1", "--model", "arx", "--file", "/proc/self/stat"}),
            "accepted");
}

TEST(CommandLineTest, HelpShowsWhatAnOptionTakesAndItsDefault) {
  const std::string help = Made().sut.help();
  EXPECT_THAT(help, AllOf(HasSubstr("INT in [1 - 12]"), ContainsRegex("=4|\\[4\\]"),
                          HasSubstr("{auto,arx}")));
}

TEST(CommandLineTest, TheLastWordCountsExceptOfARepeatableOption) {
  Made made;
  made.sut.parse({"--order", "2", "--topics", "a", "--order", "3", "--topics", "b"});
  EXPECT_EQ(made.order, 3);
  EXPECT_THAT(made.topics, ElementsAre("a", "b"));
  EXPECT_EQ(Made().refusal_of({"--topics", "a", "b"}),
            "The following argument was not expected: b");
}

TEST(CommandLineTest, AProgramEndsWithTheStatusAndTheTextOfItsCommandLine) {
  const auto ended = [](const char* word) {
    std::string name = "made";
    std::string option = word;
    std::array<char*, 2> words{name.data(), option.data()};
    return Made().sut.parse(2, words.data());
  };
  testing::internal::CaptureStdout();
  EXPECT_EQ(ended("--help"), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("made for a test"));
  testing::internal::CaptureStderr();
  EXPECT_EQ(ended("--none"), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "The following argument was not expected: --none\n"
            "Run with --help for more information.\n");
  EXPECT_EQ(ended("--order=5"), std::nullopt);
}

}  // namespace
}  // namespace stillhand::command_line::command_line_test
