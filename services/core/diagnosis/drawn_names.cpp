// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/drawn_names.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>

#include "services/core/signal/random.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kDraws = 100;
constexpr std::uint64_t kSeed = 92;

// As many of the blocks as there are, some more than once.
std::vector<std::size_t> drawn_blocks(std::size_t count, signal::Gaussian& random) {
  std::vector<std::size_t> blocks(count);
  for (std::size_t& block : blocks) {
    block = std::min(count - 1,
                     static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
  }
  return blocks;
}

HeldOut drawn(const HeldOut& all, const std::vector<std::size_t>& blocks) {
  HeldOut some{all.finite, {}, {}};
  for (const std::size_t block : blocks) {
    some.squares.push_back(all.squares[block]);
    some.weights.push_back(all.weights[block]);
  }
  return some;
}

}  // namespace

std::optional<NameCounts> drawn_names(const SearchResult& search, const SearchOptions& options) {
  // To pass over samples explains nothing, and was not always chosen by its blocks (DG-53).
  const auto added = std::ranges::find_if_not(search.additions, [](const Addition& addition) {
    return passes_over_samples(addition.tried[addition.chosen]);
  });
  const bool found = added != search.additions.end();
  if (!found && !search.additions.empty()) return {};
  std::vector<Trial> tried = found ? added->tried : search.last_tried;
  const HeldOut& current = found ? added->current : search.last_current;
  const std::size_t candidates = tried.size();
  const std::size_t blocks = current.squares.size();
  std::erase_if(tried, [&](const Trial& trial) {
    return !std::isfinite(trial.rmse) || trial.held_out.squares.size() != blocks;
  });
  if (tried.empty()) return {};
  const std::vector<Trial> all = tried;
  std::map<std::string, int> counts;
  signal::Gaussian random(kSeed, 0);
  for (int i = 0; i < kDraws; ++i) {
    const std::vector<std::size_t> own = drawn_blocks(blocks, random);
    for (std::size_t k = 0; k < tried.size(); ++k) {
      tried[k].held_out = drawn(all[k].held_out, own);
      tried[k].rmse = tried[k].held_out.rmse();
    }
    const std::size_t chosen =
        added_of(tried, drawn(current, own), options.first_least_fall, candidates, options);
    ++counts[chosen == tried.size() ? kNoName : tried[chosen].model.effects.back().kind];
  }
  NameCounts names{kDraws, {counts.begin(), counts.end()}};
  std::ranges::stable_sort(names.counts, std::ranges::greater(),
                           &std::pair<std::string, int>::second);
  return names;
}

}  // namespace stillhand::diagnosis
