// SPDX-License-Identifier: Apache-2.0
// Eq. DR-31: which answers are taken for an exchange, when lines are missing, damaged, late or in
// another order.
#include "services/core/device_rig/odrive_exchange.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace stillhand::device_rig::odrive {
namespace {

using Verdict = AnswerReader::Verdict;

std::string checked(const std::string& text) {
  return text + "*" + std::to_string(checksum_of(text));
}

/// The lines with which a healthy drive answers exchange `number`.
std::vector<std::string> answers_to(std::uint64_t number, int uptime_ms = 123456) {
  const char* const extra = extra_of(number) == Extra::kCurrent ? "0.000000" : "0";
  return {"0.012345 -0.250000", "8", std::to_string(uptime_ms), "0", extra, std::to_string(number)};
}

class AnswerReaderTest : public testing::Test {
 protected:
  /// @returns how many exchanges were whole
  int take(const std::vector<std::string>& lines) {
    int whole = 0;
    for (const std::string& each : lines) {
      const Verdict verdict = sut_.take(checked(each));
      if (verdict == Verdict::kWhole) ++whole;
      if (verdict == Verdict::kDamaged) ++damaged_;
    }
    return whole;
  }

  AnswerReader sut_;
  int damaged_ = 0;
};

TEST_F(AnswerReaderTest, ReadsAnExchange) {
  const std::uint64_t number = sut_.ask();
  ASSERT_EQ(take(answers_to(number)), 1);
  EXPECT_EQ(sut_.answers().position_turns, 0.012345);
  EXPECT_EQ(sut_.answers().velocity_turns_s, -0.25);
  EXPECT_EQ(sut_.answers().state, kClosedLoop);
  EXPECT_EQ(sut_.answers().uptime_ms, 123456u);
  EXPECT_EQ(sut_.answers().number, number);
  EXPECT_EQ(damaged_, 0);
}

TEST_F(AnswerReaderTest, TwoExchangesMayBeUnderWay) {
  const std::uint64_t first = sut_.ask();
  const std::uint64_t second = sut_.ask();
  EXPECT_EQ(take(answers_to(first)), 1);
  EXPECT_EQ(take(answers_to(second)), 1);
}

TEST_F(AnswerReaderTest, AMissingLineLosesItsExchangeAndNoOther) {
  for (std::size_t missing = 0; missing < AnswerReader::kMostAnswers; ++missing) {
    auto lines = answers_to(sut_.ask());
    lines.erase(lines.begin() + static_cast<long>(missing));
    const auto next = answers_to(sut_.ask());
    lines.insert(lines.end(), next.begin(), next.end());
    EXPECT_EQ(take(lines), 1) << missing;
    EXPECT_EQ(std::to_string(sut_.answers().number), next.back());
  }
  EXPECT_GE(damaged_, 6);
}

// A swap leaves no exchange, or one that ends the torque: a counter that goes back, or a fault.
TEST_F(AnswerReaderTest, ASwapOfTwoNeighboursNeverGivesAHealthyExchange) {
  for (std::size_t place = 0; place + 1 < AnswerReader::kMostAnswers; ++place) {
    for (int turn = 0; turn < 4; ++turn) {
      auto lines = answers_to(sut_.ask());
      lines[3] = "2048";
      std::swap(lines[place], lines[place + 1]);
      const int whole = take(lines);
      const Answers& seen = sut_.answers();
      const bool fault =
          seen.axis_error != 0 || (extra_of(seen.number) != Extra::kCurrent && seen.extra != 0.0);
      EXPECT_TRUE(whole == 0 || fault) << place << ' ' << turn;
    }
  }
}

// Two error words of 0 may change places: nobody can see it, and it changes nothing.
TEST_F(AnswerReaderTest, AStateAndACounterThatChangePlacesAreDamage) {
  auto lines = answers_to(sut_.ask());
  std::swap(lines[1], lines[2]);
  EXPECT_EQ(take(lines), 0);
}

TEST_F(AnswerReaderTest, AnAnswerThatCameAlreadyOrWasNeverAskedForIsNone) {
  const auto lines = answers_to(sut_.ask());
  EXPECT_EQ(take(lines), 1);
  EXPECT_EQ(take(lines), 0);
  EXPECT_EQ(take(answers_to(AnswerReader::kFirst + 1)), 0);
  sut_.ask();
  EXPECT_EQ(take(answers_to(AnswerReader::kFirst + 1)), 1);
}

TEST_F(AnswerReaderTest, WordsInThePlaceOfNumbersAreDamage) {
  for (std::size_t place = 0; place < AnswerReader::kMostAnswers; ++place) {
    for (const char* word : {"invalid property", "not implemented", "nan nan", "", "-1"}) {
      if (place == 4 && std::string(word) == "-1") continue;  // a current may be negative
      auto lines = answers_to(sut_.ask());
      lines[place] = word;
      EXPECT_EQ(take(lines), 0) << place << ' ' << word;
    }
  }
}

TEST_F(AnswerReaderTest, ALineWithoutChecksumIsDamage) {
  sut_.ask();
  EXPECT_EQ(sut_.take("0.012345 -0.250000"), Verdict::kDamaged);
}

TEST(PutQuestionsTest, FitABufferOfTheDrive) {
  // A line of the drive holds 256 characters, its USB packet 64; its answers 512 together.
  Lines lines;
  lines.add("c 0 ", -123.456789);
  lines.add("sc");
  lines.add("w axis0.requested_state 8");
  for (std::uint64_t number = AnswerReader::kLast - 3; number <= AnswerReader::kLast; ++number) {
    Lines sut = lines;
    put_questions(sut, 0, number);
    EXPECT_TRUE(sut.good());
  }
}

}  // namespace
}  // namespace stillhand::device_rig::odrive
