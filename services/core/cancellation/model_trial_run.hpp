// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/cancellation/model_check.hpp"

namespace stillhand::cancellation {

/// METHOD Eq. CC-14, by running the model's filter.  True where the model asks for no more than
/// kMaxRest_n while nothing moves, once it has settled; waves are bounded by check_strength().
/// @param settle  [ticks] of the model's slowest pole
bool rests(const ControlModel& model, std::int64_t settle);

/// METHOD Eq. CC-14 for a spring inside the body (Eq. CC-7): stable with its least, middle and
/// greatest slope, and a trial run through the motion's band stays bounded and dies away, to what a
/// spring with memory may hold.  A test, no proof: the force envelope stands behind it.  Takes
/// milliseconds.
Refusal check_loop(const ControlModel& model, std::int64_t settle, const ModelBounds& bounds);

}  // namespace stillhand::cancellation
