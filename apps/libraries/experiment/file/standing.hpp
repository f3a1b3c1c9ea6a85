// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/experiment/core/progress.hpp"

namespace stillhand::experiment {

/// How far an experiment is, by its journals alone: the orders do not matter.
struct Standing {
  std::vector<std::string> complete;                            ///< codes
  std::vector<std::pair<std::string, std::string>> excluded;    ///< code, reason
  std::vector<std::pair<std::string, std::string>> incomplete;  ///< code, "2 of 3 trials"
  std::vector<Entry> openings;  ///< kUnblinded, in the order of the folder's journal

  /// All planned participants.
  [[nodiscard]] std::size_t planned() const noexcept {
    return complete.size() + excluded.size() + incomplete.size();
  }
};

/// @throws ConfigError for a journal that cannot be read, or of another plan
Standing standing_of(const std::filesystem::path& folder, const Design& design);

/// "P02 (2 of 3 trials), P03 (not begun)"
std::string in_words(const std::vector<std::pair<std::string, std::string>>& participants);
/// "1 of 3 participants complete; 1 excluded: P02 (felt sick); 1 not complete: P03 (not begun)."
std::string in_words(const Standing& standing);
/// "P02 alone was unblinded at 2026-11-27T00:00:00Z, with 1 of 3 participants complete: felt sick."
std::string in_words(const Entry& opening, std::size_t planned);

}  // namespace stillhand::experiment
