// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/model/model.hpp"

namespace stillhand::diagnosis {

/// Why a model that was fitted is none.
struct NoModel {
  std::string reason;  ///< "unrelated", "clocks", "unit", "sign", "swapped", "samples", "copy"
  std::string why;     ///< one sentence without its stop
};

/// METHOD Eq. DG-81: an output that leads, or input and output swapped, judged before an effect
/// describes that.
std::optional<NoModel> exchanged_of(const Measurement& measurement, const Signals& signals,
                                    const Blocks& blocks, const Model& baseline, int order,
                                    double heaviest_kg);

/// METHOD Eq. DG-79: whether the inputs explain anything of what time alone does not, on held-out
/// blocks; and whether another reading of the recording halves the squared error that is left: two
/// clocks (Eq. DG-78), input and output swapped, another sign or unit in one of several recordings.
/// @param measurement  that the signals were made of
/// @param model        the final one
/// @param heldout_rmse [unit of the output] of the final model
/// @param order        of the models that other readings are fitted with
/// @param heaviest_kg  [kg] of a body, Eq. DG-80
std::optional<NoModel> no_model_of(const Measurement& measurement, const Signals& signals,
                                   const Blocks& blocks, const Model& model, double heldout_rmse,
                                   int order, double heaviest_kg);

}  // namespace stillhand::diagnosis
