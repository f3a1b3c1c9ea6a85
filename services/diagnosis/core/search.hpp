// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/core/baseline.hpp"
#include "diagnosis/core/effect_kind.hpp"
#include "diagnosis/core/fit.hpp"

namespace stillhand::diagnosis {

/// Calls task(0) to task(count - 1), in any order, perhaps at once, and returns when all are done.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;
/// One after the other.
void in_order(std::size_t count, const std::function<void(std::size_t)>& task);

/// How two models' held-out errors compare, block by block, README Eq. DG-16.
struct Comparison {
  double rmse_ratio = 1.0;  ///< [-] after / before
  double t = 0.0;           ///< [-] mean of the blocks' differences over its standard error
  double p = 1.0;           ///< [-] of such signs and ranks by chance: Wilcoxon's signed-rank test
  double share_better = 0.0;  ///< [-] of the blocks
};

Comparison compared(const HeldOut& before, const HeldOut& after);

/// A model that was tried.
struct Trial {
  Model model;
  HeldOut held_out;
  double rmse = 0.0;      ///< held out
  std::size_t added = 0;  ///< index of the effect that it tried
};

/// One effect that was added, and what it was chosen against.
struct Addition {
  HeldOut before;
  HeldOut after;
  Comparison comparison;
  std::vector<Trial> tried;       ///< best first, the chosen one included
  std::size_t chosen = 0;         ///< in `tried`
  std::vector<std::string> ties;  ///< other kinds that explain as much: one standard error, or
                                  ///< `tie` and `tied_gain`
};

/// Settings of the search; the figures' origin: README "Selection".
struct SearchOptions {
  std::size_t most_effects = 4;
  double first_least_fall = 0.005;  ///< [-] of the held-out error: is anything missing at all?
  double least_fall = 0.01;     ///< [-] later: less is what the first one's form leaves of itself
  double significance = 0.001;  ///< [-] divided by the number of candidates (Bonferroni)
  double large_fall = 0.15;     ///< [-] of the held-out error: significance not divided,
  double large_significance = 0.01;  ///< [-] and this one
  double tie = 0.03;                 ///< [-] of the held-out error,
  double tied_gain = 0.95;           ///< [-] and of the gain: the simpler wins
  int screening_iterations = 5;
  int fit_iterations = 30;
};

/// What the search found.
struct SearchResult {
  Model model;
  std::vector<Addition> additions;  ///< one an effect of the model, in its order
  std::size_t removed = 0;          ///< effects that later ones made idle
  std::vector<Trial> last_tried;    ///< after the last addition, best first: all were rejected
};

/// Forward selection with re-testing, README "Selection": propose, fit jointly, compare on held-out
/// blocks, add the simplest of the best; after each addition the earlier ones must stay worth it.
SearchResult search(const Baseline& baseline, const Signals& signals, const Blocks& blocks,
                    const SearchOptions& options, const ForEach& for_each,
                    const std::function<bool(const std::string&)>& progress);

}  // namespace stillhand::diagnosis
