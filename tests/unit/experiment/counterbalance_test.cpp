// SPDX-License-Identifier: Apache-2.0
// Properties of the orders for every number of conditions that an experiment can have, and more.
#include "apps/libraries/experiment/core/counterbalance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

namespace stillhand::experiment::counterbalance_test {
namespace {

constexpr std::size_t kMostConditions = 9;
constexpr std::uint64_t kSeeds = 20;

using Counts = std::map<std::pair<std::size_t, std::size_t>, int>;

// How often each condition is at each place.
Counts at_places(const Square& rows) {
  Counts counts;
  for (const auto& row : rows) {
    for (std::size_t place = 0; place < row.size(); ++place) ++counts[{row[place], place}];
  }
  return counts;
}

// How often each ordered pair of conditions are neighbours.
Counts neighbours(const Square& rows) {
  Counts counts;
  for (const auto& row : rows) {
    for (std::size_t place = 1; place < row.size(); ++place) {
      ++counts[{row[place - 1], row[place]}];
    }
  }
  return counts;
}

void expect_all_equal(const Counts& counts, std::size_t entries, int each) {
  EXPECT_EQ(counts.size(), entries);
  for (const auto& [key, count] : counts) {
    EXPECT_EQ(count, each) << key.first << ", " << key.second;
  }
}

// The orders of one whole round of participants, from any first one, in any pass.
Square round(Order order, std::size_t n, std::uint64_t seed, std::size_t first, std::size_t pass) {
  Square rows;
  for (std::size_t i = 0; i < round_of(order, n); ++i) {
    rows.push_back(condition_order(order, n, seed, first + i, pass));
  }
  return rows;
}

TEST(CounterbalanceTest, EveryOrderHasEachConditionOnce) {
  for (const Order order : {Order::kRandom, Order::kLatin, Order::kWilliams}) {
    for (std::size_t n = 1; n <= kMostConditions; ++n) {
      for (std::size_t participant = 0; participant < 2 * n; ++participant) {
        auto sut = condition_order(order, n, 7, participant, participant % 3);
        std::ranges::sort(sut);
        ASSERT_EQ(sut.size(), n);
        for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(sut[i], i);
      }
    }
  }
}

TEST(CounterbalanceTest, ALatinRoundHasEachConditionOnceAtEachPlace) {
  for (std::size_t n = 1; n <= kMostConditions; ++n) {
    ASSERT_EQ(round_of(Order::kLatin, n), n);
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      expect_all_equal(at_places(round(Order::kLatin, n, seed, seed % 5, seed % 3)), n * n, 1);
    }
  }
}

TEST(CounterbalanceTest, AWilliamsRoundHasEachConditionAndEachPairOfNeighboursEquallyOften) {
  for (std::size_t n = 2; n <= kMostConditions; ++n) {
    const int each = n % 2 == 0 ? 1 : 2;
    ASSERT_EQ(round_of(Order::kWilliams, n), n * static_cast<std::size_t>(each));
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const Square sut = round(Order::kWilliams, n, seed, seed % 5, seed % 3);
      expect_all_equal(at_places(sut), n * n, each);
      expect_all_equal(neighbours(sut), n * (n - 1), each);
    }
  }
}

TEST(CounterbalanceTest, RandomOrdersDifferBetweenParticipantsAndFollowFromTheSeed) {
  Square sut, again;
  for (std::size_t i = 0; i < 60; ++i) {
    sut.push_back(condition_order(Order::kRandom, 3, 5, i, 0));
    again.push_back(condition_order(Order::kRandom, 3, 5, i, 0));
  }
  EXPECT_EQ(sut, again);
  std::map<std::vector<std::size_t>, int> seen;
  for (const auto& row : sut) ++seen[row];
  EXPECT_EQ(seen.size(), 6u);  // 60 draws miss one of 6 orders with probability 1e-4; one seed
}

}  // namespace
}  // namespace stillhand::experiment::counterbalance_test
