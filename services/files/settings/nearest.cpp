// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/nearest.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace stillhand::settings {
namespace {

// Insertion, deletion and substitution count one each.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t substituted = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string_view> candidates) {
  const auto found = std::ranges::min_element(
      candidates, {}, [&](std::string_view each) { return edit_distance(word, each); });
  return found == candidates.end() ? std::string() : std::string(*found);
}

std::string suggestion(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string found = nearest(word, candidates);
  // Among few words, one is always the nearest.
  if (3 * edit_distance(word, found) <= std::max(word.size(), found.size())) {
    return "\"" + found + "\" perhaps";
  }
  std::string list;
  for (const std::string_view each : candidates) {
    list += (list.empty() ? "one of " : ", ") + std::string(each);
  }
  return list;
}

}  // namespace stillhand::settings
