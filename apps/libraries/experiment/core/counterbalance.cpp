// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/core/counterbalance.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "apps/libraries/experiment/core/seeds.hpp"

namespace stillhand::experiment {
namespace {

std::vector<std::size_t> counted(std::size_t n) {
  std::vector<std::size_t> row(n);
  std::iota(row.begin(), row.end(), std::size_t{0});
  return row;
}

// Rows (r + first_p) mod n for every r.
Square developed(const std::vector<std::size_t>& first) {
  const std::size_t n = first.size();
  Square square;
  for (std::size_t r = 0; r < n; ++r) {
    std::vector<std::size_t> row;
    row.reserve(n);
    for (const std::size_t entry : first) row.push_back((r + entry) % n);
    square.push_back(row);
  }
  return square;
}

Square square_of(Order order, std::size_t n) {
  return order == Order::kLatin ? latin_square(n) : williams_square(n);
}

}  // namespace

Square latin_square(std::size_t n) { return developed(counted(n)); }

Square williams_square(std::size_t n) {
  std::vector<std::size_t> first{0};
  for (std::size_t step = 1; first.size() < n; ++step) {
    first.push_back(step);
    if (first.size() < n) first.push_back(n - step);
  }
  Square square = developed(first);
  if (n % 2 == 0) return square;
  for (std::size_t r = 0; r < n; ++r) {
    square.emplace_back(square[r].rbegin(), square[r].rend());
  }
  return square;
}

Square drawn(Square square, std::uint64_t seed) {
  if (square.empty()) return square;
  std::mt19937_64 engine(derived_seed(seed, SeedUse::kSquare));
  std::vector<std::size_t> names = counted(square.front().size());
  std::shuffle(names.begin(), names.end(), engine);
  for (auto& row : square) {
    for (std::size_t& entry : row) entry = names[entry];
  }
  std::shuffle(square.begin(), square.end(), engine);
  return square;
}

std::vector<std::size_t> condition_order(Order order, std::size_t conditions, std::uint64_t seed,
                                         std::size_t participant, std::size_t pass) {
  if (order == Order::kRandom) {
    std::vector<std::size_t> row = counted(conditions);
    std::mt19937_64 engine(derived_seed(seed, SeedUse::kOrder, participant, pass));
    std::shuffle(row.begin(), row.end(), engine);
    return row;
  }
  const Square square = drawn(square_of(order, conditions), seed);
  return square[(participant + pass) % square.size()];
}

std::size_t round_of(Order order, std::size_t conditions) {
  return order == Order::kRandom ? 1 : square_of(order, conditions).size();
}

}  // namespace stillhand::experiment
