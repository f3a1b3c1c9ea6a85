// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stillhand::experiment {

/// How the conditions follow each other over participants.
enum class Order : std::uint8_t { kRandom, kLatin, kWilliams };

/// Rows of condition numbers, each a permutation of 0 .. n-1.
using Square = std::vector<std::vector<std::size_t>>;

/// The cyclic Latin square, Eq. EX-1:  row r, place p:  (r + p) mod n.
/// n rows; every condition is once at each place.  n >= 1.
Square latin_square(std::size_t n);

/// The square of Williams (1949), Eq. EX-2:  row r, place p:  (r + w_p) mod n with
/// w = 0, 1, n-1, 2, n-2, ...  n rows for even n; for odd n also the mirrored rows, 2 n in all.
/// Every condition is equally often at each place, and every ordered pair of neighbours occurs
/// equally often: once for even n, twice for odd n.  n >= 1.
Square williams_square(std::size_t n);

/// A square with conditions renamed and rows shuffled by the seed; both keep its balance.
Square drawn(Square square, std::uint64_t seed);

/// The order of the conditions in one pass of one participant.
/// kLatin, kWilliams: row (participant + pass) mod rows of the drawn square, Eq. EX-3, so every
/// pass is balanced over each whole round of participants.  kRandom: a permutation of its own.
/// @param participant  from 0;  @param pass  of all blocks together, from 0
std::vector<std::size_t> condition_order(Order order, std::size_t conditions, std::uint64_t seed,
                                         std::size_t participant, std::size_t pass);

/// Number of participants after which the order is balanced; 1 for kRandom.
std::size_t round_of(Order order, std::size_t conditions);

}  // namespace stillhand::experiment
