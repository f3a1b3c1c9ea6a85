// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/model/evaluation.hpp"

/// Where a model was seen, and where a recording leaves that range, METHOD Eq. DG-56.  Pure.
namespace stillhand::diagnosis {

/// Sets the ranges of a fitted model's effects: what each of them reads over the samples that
/// weigh.  From then on a free run holds each effect at its edges.
void note_seen(Model& model, const Signals& signals);

/// Ranges of the inputs over the samples that weigh.
std::vector<SeenRange> input_ranges(const Signals& signals);

/// A range that a recording leaves.
struct LeftRange {
  std::string effect;  ///< its kind; empty: the linear body, which goes on as it is
  SeenRange range;
  double share = 0.0;  ///< [-] of the samples that weigh
};

/// @param run  of the model over the signals
std::vector<LeftRange> left_ranges(const Model& model, const std::vector<SeenRange>& inputs,
                                   const Signals& signals, const FreeRun& run);

}  // namespace stillhand::diagnosis
