// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/identify/identify.hpp"
#include "services/core/diagnosis/no_model.hpp"
#include "services/core/identification/record.hpp"

namespace stillhand::identify {

/// What makes a fit worthless although there is one: unsound or clipped samples, a mass that is no
/// hand's (DG-80), another clock (DG-78), swapped columns (DG-81), a copy (DG-84), or that it
/// explains nothing.  `reason` is one of NoModel's, or "effects" where diagnose has some for it.
/// @param fitted  the record that `result` was fitted to
std::optional<diagnosis::NoModel> why_worthless(const diagnosis::Measurement& measurement,
                                                const IdentifyOptions& options,
                                                const identification::Record& fitted,
                                                const IdentifyResult& result);

}  // namespace stillhand::identify
