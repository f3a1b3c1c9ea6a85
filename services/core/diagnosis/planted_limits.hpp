// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/diagnosis/trials.hpp"

namespace stillhand::diagnosis {

/// [-] RMS of what is planted, over that of the residual.
inline constexpr std::array kPlantedSizes{0.1, 0.3, 1.0};

/// What the search says of one kind that was planted into what this record leaves, Eq. DG-62.
struct PlantedLimit {
  std::string kind;
  std::string channel;  ///< that it reads besides the first input; empty: none
  std::array<double, kPlantedSizes.size()> found{};  ///< [-] share of the residuals, by size
  /// [unit of the output] RMS of what it adds to the output where half are found; infinite: not
  /// within 20 times the residual.
  double half = 0.0;
  double beyond_linear = 0.0;  ///< [-] of it, what the model without it cannot imitate
};

/// What the search would have to pass.
struct LastRound {
  std::size_t candidates = 0;  ///< [-] that it tries
  double least_fall = 0.0;     ///< [-] of the held-out error
};

/// Plants every kind into the record's own residual, moved in time, and asks the rule of the
/// search, Eq. DG-62; of several channels of a kind the one that is hardest to find.  The kinds in
/// the order of effect_kinds().  Empty where nothing is left.
/// @param model  fitted to the signals
/// @param whitened  the same signals behind the noise model, Eq. DG-61, or as they are
std::vector<PlantedLimit> planted_limits(const Model& model, const Signals& signals,
                                         const Signals& whitened, const Blocks& blocks,
                                         const LastRound& round, const SearchOptions& options,
                                         const ForEach& for_each);

/// [unit of the output] the median, over the kinds that are found at all, of what is found in half
/// of the residuals, as far as the model cannot imitate it; 0: none is.
double typical_limit(const std::vector<PlantedLimit>& limits);

}  // namespace stillhand::diagnosis
