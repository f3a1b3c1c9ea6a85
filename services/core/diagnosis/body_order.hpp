// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/selection.hpp"

namespace stillhand::diagnosis {

/// METHOD Eq. DG-88: the one with the bend stays.
bool outdoes(const HeldOut& bent, const HeldOut& straight, const SearchOptions& options);

/// METHOD Eq. DG-88: a body of too low an order leaves more than it must, and a bend or a memory
/// between input and output may imitate the modes that it lacks.
/// @param model  as the search leaves it
/// @param order  p of its search
/// @param impulse_response_rmse  what a long response leaves, Eq. DG-13; NaN: not known
/// @return the order at which the search is worth beginning again; nothing: the model's own
std::optional<int> order_instead(const Model& model, const Signals& signals, const Blocks& blocks,
                                 int order, double impulse_response_rmse,
                                 const SearchOptions& options);

}  // namespace stillhand::diagnosis
