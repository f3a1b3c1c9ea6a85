// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/tie.hpp"

#include <fmt/format.h>

namespace stillhand::next_run {

std::string Tie::in_words() const {
  if (broken()) {
    return fmt::format("of {} causes that are close the whole recording leaves {}", close.size(),
                       name_of(left.front()));
  }
  std::string names;
  for (std::size_t i = 0; i < left.size(); ++i) {
    names += (i == 0 ? "" : i + 1 < left.size() ? ", " : " and ") + name_of(left[i]);
  }
  return "tied on this recording: " + names;
}

std::vector<Tie> ties_of(const diagnosis::Diagnosis& diagnosis, const diagnosis::Signals& signals) {
  std::vector<Tie> ties;
  for (std::size_t e = 0; e < diagnosis.search.additions.size(); ++e) {
    Tie tie{e, candidates_of(diagnosis, e, signals)};
    if (tie.close.size() < 2) continue;
    tie.left = Contest(tie.close, signals).still_tied();
    ties.push_back(std::move(tie));
  }
  return ties;
}

}  // namespace stillhand::next_run
