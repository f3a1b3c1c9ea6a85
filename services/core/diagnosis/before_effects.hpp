// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/core/diagnosis/no_model.hpp"

/// What speaks against a model before an effect can describe it.
namespace stillhand::diagnosis {

/// Samples that the screening calls unsound, and an output that is a copy of an input (DG-84).
std::optional<NoModel> before_any_fit(const Measurement& measurement,
                                      const std::vector<std::string>& inputs,
                                      const std::string& output);

/// METHOD Eq. DG-78: one channel late by a constant time; a lag that grows may be an effect.
std::optional<NoModel> late_of(const Measurement& measurement, const Signals& signals,
                               const Blocks& blocks, const Model& baseline, int order);

}  // namespace stillhand::diagnosis
