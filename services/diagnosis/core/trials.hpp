// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "services/diagnosis/core/fitting/blocks.hpp"
#include "services/diagnosis/core/fitting/impulse_response.hpp"
#include "services/diagnosis/core/selection.hpp"

/// One round of the search: every form that is proposed, fitted and judged.
namespace stillhand::diagnosis {

/// Calls task(0) to task(count - 1), in any order or in parallel; returns when all are done.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;
/// One after the other.
void in_order(std::size_t count, const std::function<void(std::size_t)>& task);

/// Which kinds a round tries: those with a law, or those that take any shape.
enum class Shapes { kNamed, kAny };

/// The model fitted in at most `iterations` steps, and its held-out error: by refitting, Eq. DG-12
/// by one linearisation otherwise.
Trial judged_trial(Model model, const Signals& signals, const Blocks& blocks, int iterations,
                   bool refitting);

/// True when the last effect leaves samples out and explains none.
bool passes_over_samples(const Trial& trial);

/// The body that was fitted without the effects may be in a local minimum.  A body estimated again
/// from what the effects leave of the output replaces it where it is better.  The full order is
/// tried too: an effect may have hidden poles of a body whose order was reduced.
void start_afresh(Model& model, const Signals& signals, int order);

/// Everything that is proposed, fitted jointly in two passes: a few steps for all, then to the end
/// for those near the best.  Best first.
/// @param current_rmse  held out, of the model without any of them
/// @param order  of the body, before it was reduced
std::vector<Trial> trials(const Model& current, double current_rmse, const Signals& signals,
                          const Blocks& blocks, const ImpulseResponse& impulse_response, int order,
                          const SearchOptions& options, const ForEach& for_each,
                          Shapes shapes = Shapes::kNamed);

}  // namespace stillhand::diagnosis
