// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/drawn_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::diagnosis::drawn_names_test {

using testing::ElementsAre;
using testing::Pair;

constexpr std::size_t kBlocks = 30;

HeldOut held_out(const std::vector<double>& squares) {
  return {true, squares, std::vector<double>(squares.size(), 1.0)};
}

// An effect of that kind that leaves `squares` of the blocks.
Trial tried(const char* kind, const std::vector<double>& squares) {
  Trial trial;
  trial.model.effects = {{kind, "of the input", {}, {{"number", "s", 0.1, 0.0, 1.0}}, {}}};
  trial.held_out = held_out(squares);
  trial.rmse = trial.held_out.rmse();
  return trial;
}

// Each block a little different from the next.
std::vector<double> squares(double mean) {
  std::vector<double> values(kBlocks);
  for (std::size_t b = 0; b < kBlocks; ++b) {
    values[b] = mean * (1.0 + 0.001 * static_cast<double>(b));
  }
  return values;
}

SearchResult round_of(std::vector<Trial> all) {
  SearchResult search;
  Addition addition;
  addition.current = held_out(squares(4.0));
  addition.tried = std::move(all);
  search.additions = {std::move(addition)};
  return search;
}

TEST(DrawnNamesTest, WhatEveryBlockShowsIsNamedInEveryDraw) {
  const auto sut =
      drawn_names(round_of({tried("delay", squares(1.0)), tried("clock_drift", squares(3.0))}), {});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->repetitions, 100);
  EXPECT_THAT(sut->counts, ElementsAre(Pair("delay", 100)));
}

// Better by what six of thirty blocks show: where few of these are drawn, the other one wins.
TEST(DrawnNamesTest, ANameThatHangsOnFewBlocksIsLostInSomeDraws) {
  std::vector<double> few = squares(1.6);
  for (std::size_t b = 0; b < kBlocks; b += 5) few[b] = 0.01;
  const auto sut =
      drawn_names(round_of({tried("delay", few), tried("clock_drift", squares(1.2))}), {});
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->counts.size(), 2U);
  int all = 0;
  for (const auto& [name, count] : sut->counts) {
    EXPECT_GT(count, 5) << name;
    all += count;
  }
  EXPECT_EQ(all, 100);
}

TEST(DrawnNamesTest, WhatIsNotWorthAddingIsNothing) {
  SearchResult search;
  search.last_current = held_out(squares(1.0));
  search.last_tried = {tried("delay", squares(0.9999))};
  const auto sut = drawn_names(search, {});
  ASSERT_TRUE(sut);
  EXPECT_THAT(sut->counts, ElementsAre(Pair(kNoName, 100)));
  EXPECT_FALSE(drawn_names({}, {})) << "without a round there is none";
}

}  // namespace stillhand::diagnosis::drawn_names_test
