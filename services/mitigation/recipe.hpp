// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/mitigation/core/part.hpp"
#include "services/mitigation/mitigation.hpp"

namespace stillhand::mitigation {

/// What a session has identified so far.
struct SessionModels {
  std::optional<cancellation::ControlModel> force = {};  ///< pegged, or the one given in its place
  std::optional<signal::DifferenceModel> position = {};  ///< G at 1 kHz: m per m/s^2
};

/// The recipe of a live trial.
/// @param canceller  settings of the process: its limits bound the sum of all forces
/// @throws stillhand::ConfigError for no part, an unknown kind, a kind twice (both filters on the
///         command are one), another number of values, a hand or an arm out of range, a model of a
///         position that CC-4 refuses or of more than 0.06 m per m/s^2, or a model that is missing;
///         Mitigation itself refuses the other values out of range.
Recipe recipe_of(const std::vector<Part>& parts, const SessionModels& models,
                 const cancellation::Config& canceller);

}  // namespace stillhand::mitigation
