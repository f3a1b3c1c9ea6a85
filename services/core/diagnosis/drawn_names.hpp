// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/diagnosis/search.hpp"

namespace stillhand::diagnosis {

/// How often each name comes out of as many repetitions; the most frequent first.
struct NameCounts {
  int repetitions = 0;
  std::vector<std::pair<std::string, int>> counts;
};

/// "nothing" among the names of drawn_names(): none is worth adding.
inline constexpr const char* kNoName = "nothing";

/// METHOD Eq. DG-92: the round of the strongest effect, or the last one without an effect, judged
/// on its blocks drawn with replacement, 100 times.  Nothing is fitted.
/// @return nullopt without such a round
std::optional<NameCounts> drawn_names(const SearchResult& search, const SearchOptions& options);

}  // namespace stillhand::diagnosis
