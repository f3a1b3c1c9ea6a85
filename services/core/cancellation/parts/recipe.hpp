// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "services/core/cancellation/config.hpp"
#include "services/core/cancellation/part.hpp"
#include "services/core/cancellation/parts/part_list.hpp"

namespace stillhand::cancellation {

/// The recipe of a live trial.
/// @param position  feedthrough to position that the session has identified, at 1 kHz
/// @param config    settings of the process
/// @throws stillhand::ConfigError for no part, an unknown kind, a kind twice (both filters on the
///         command are one), another number of values, a hand or an arm out of range, a model of a
///         position that CC-4 refuses or of more than 0.06 m per m/s^2, or one that is missing,
///         gain and phase that are followed by a model below 1 kHz; PartList itself refuses the
///         other values out of range.
Recipe recipe_of(const std::vector<Part>& parts,
                 const std::optional<signal::DifferenceModel>& position, const Config& config);

}  // namespace stillhand::cancellation
