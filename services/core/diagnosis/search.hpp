// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {

/// One effect that was added, and the candidates that it was chosen from.
struct Addition {
  HeldOut before;   ///< [unit of the output]
  HeldOut after;    ///< likewise
  HeldOut current;  ///< `before` as the candidates were judged: behind the noise model's filter
  Comparison comparison;          ///< with the chosen one, as judged
  std::vector<Trial> tried;       ///< best first, the chosen one included
  std::size_t chosen = 0;         ///< in `tried`
  std::vector<std::string> ties;  ///< other kinds that explain as much: one standard error, or
                                  ///< `tie` and `tied_gain`
};

/// An effect that the blocks support, but the recordings that were joined do not.
struct RefutedEffect {
  Effect effect;
  std::vector<double> fall;  ///< [-] of each recording's error, held out whole
};

/// An effect that the blocks support, but surrogates of the residual give as well.
struct EffectByChance {
  Effect effect;
  double fall = 0.0;  ///< [-] of the held-out error
  double p = 1.0;     ///< [-] of what it explains, by surrogates, Eq. DG-94
};

/// Result of the search.
struct SearchResult {
  Model model;
  std::vector<Addition> additions;     ///< one an effect of the model, in its order
  std::size_t removed = 0;             ///< effects that later ones replaced
  bool reordered = false;              ///< the additions stand in another order than they came in
  bool whitened = false;               ///< judged behind a noise model, Eq. DG-61
  std::vector<RefutedEffect> refuted;  ///< of all rounds
  std::vector<EffectByChance> by_chance = {};  ///< likewise
  std::vector<Trial> last_tried;  ///< after the last addition, best first: all were rejected
  HeldOut last_current;           ///< what they were compared with
};

/// Forward selection with re-testing, METHOD "Selection": propose, fit jointly, compare on held-out
/// blocks, add the simplest of the best; after each addition every earlier one is tested again.
/// Made once more where bursts (DG-53) or a spring that turns round (DG-95) may have misled it;
/// then `progress` begins again.
SearchResult search(const Baseline& baseline, const Signals& signals, const Blocks& blocks,
                    const SearchOptions& options, const ForEach& for_each,
                    const std::function<bool(const std::string&)>& progress);

}  // namespace stillhand::diagnosis
