// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "services/core/diagnosis/fitting/screening.hpp"

/// Proposals of memoryless maps at the input (Eq. DG-3) and at the output (Eq. DG-7).
namespace stillhand::diagnosis {

/// A function of a signal's value, for one value of the effect's parameter.
using Map = std::function<double(double x, double value)>;

/// A map of the first input: for each parameter value to try, the gain that its difference from the
/// identity brings at the body's output; and the best of them with a body of its own.
std::vector<Proposal> input_map_proposals(const Screening& screening, const Effect& effect,
                                          const std::vector<double>& values, const Map& difference);

/// The same for a map of the output.  @param before  the map's inverse, as far as there is one
std::vector<Proposal> output_map_proposals(const Screening& screening, const Effect& effect,
                                           const std::vector<double>& values, const Map& difference,
                                           const Map& before);

/// The inputs as measured, [inputs][samples].
std::vector<std::vector<double>> measured_inputs(const Screening& screening);

/// A body of the model's order or another, estimated again from the inputs and the output as an
/// effect maps them.
Body new_body(const Screening& screening, const std::vector<std::vector<double>>& inputs,
              const std::vector<double>& output, std::optional<int> of_order = {});

/// The effect next to this body, and what its free run explains.
Proposal with_body(const Screening& screening, const Effect& effect, Body body);

}  // namespace stillhand::diagnosis
