// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/nearest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "services/files/settings/check_name.hpp"

namespace stillhand::settings::nearest_test {

using Words = std::vector<std::string_view>;

// Levenshtein's recursion as it is defined, with no table: the oracle for short words.
std::size_t distance(std::string_view a, std::string_view b) {
  if (a.empty()) return b.size();
  if (b.empty()) return a.size();
  if (a.front() == b.front()) return distance(a.substr(1), b.substr(1));
  return 1 + std::min({distance(a.substr(1), b), distance(a, b.substr(1)),
                       distance(a.substr(1), b.substr(1))});
}

std::string random_word(std::mt19937_64& engine) {
  std::uniform_int_distribution<int> length(0, 6);
  std::uniform_int_distribution<int> letter('a', 'c');
  std::string word(static_cast<std::size_t>(length(engine)), ' ');
  for (char& c : word) c = static_cast<char>(letter(engine));
  return word;
}

TEST(NearestTest, NoCandidateIsNearerThanTheAnswer) {
  std::mt19937_64 engine(31);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::string> candidates;
    for (int k = 0; k < 5; ++k) candidates.push_back(random_word(engine));
    const std::string word = random_word(engine);
    const std::string sut = nearest(word, Words(candidates.begin(), candidates.end()));
    ASSERT_NE(std::ranges::find(candidates, sut), candidates.end());
    for (const std::string& other : candidates) {
      ASSERT_LE(distance(word, sut), distance(word, other))
          << word << ": " << sut << " or " << other;
    }
  }
}

TEST(NearestTest, TheFirstOfTwoEquallyNearOnesIsTaken) {
  EXPECT_EQ(nearest("gain", Words{"main", "rain", "gait"}), "main");
  EXPECT_EQ(nearest("gain", Words{"gait", "rain", "main"}), "gait");
}

TEST(NearestTest, AnInsertionADeletionAndASubstitutionCostTheSame) {
  // One edit each; the first other candidate is two away.
  EXPECT_EQ(nearest("mass_kg", Words{"mas_k", "masss_kg"}), "masss_kg");
  EXPECT_EQ(nearest("mass_kg", Words{"mas_k", "mss_kg"}), "mss_kg");
  EXPECT_EQ(nearest("mass_kg", Words{"mas_k", "mess_kg"}), "mess_kg");
}

TEST(NearestTest, AnEmptyWordIsNearestToTheShortestCandidate) {
  EXPECT_EQ(nearest("", Words{"four", "one", "three"}), "one");
}

TEST(NearestTest, WithoutCandidatesThereIsNoName) { EXPECT_EQ(nearest("gain", {}), ""); }

TEST(SuggestionTest, AThirdOfTheLettersMayBeOthers) {
  const Words keys{"gain", "mass_kg", "watchdog_s"};
  EXPECT_EQ(suggestion("mas_kg", keys), "\"mass_kg\" perhaps");
  EXPECT_EQ(suggestion("wachdog_ms", keys), "\"watchdog_s\" perhaps");
  // Two of seven letters, and three.
  EXPECT_EQ(suggestion("mess_kn", keys), "\"mass_kg\" perhaps");
  EXPECT_EQ(suggestion("messung", keys), "one of gain, mass_kg, watchdog_s");
}

TEST(SuggestionTest, AWordThatIsNearToNoneGetsThemAll) {
  EXPECT_EQ(suggestion("temperature", Words{"gain"}), "one of gain");
  EXPECT_EQ(suggestion("", Words{"gain", "delay"}), "one of gain, delay");
}

TEST(CheckNameTest, OnlyAnEmptyNameIsRefused) {
  EXPECT_NE(check_name(""), "");
  EXPECT_EQ(check_name(" "), "");
  EXPECT_EQ(check_name("out"), "");
}

}  // namespace stillhand::settings::nearest_test
