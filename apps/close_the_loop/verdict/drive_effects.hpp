// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "services/core/diagnosis/model/effect.hpp"

namespace stillhand::close_the_loop {

/// Adds to the canceller's model what compensates an effect of the drive, found in the force that
/// the hand needs to move the stick: friction against the sign of omega, ripple of theta.  Any
/// other effect is left out, with a reason.
/// @param share  [-] of the friction that the motor takes over: with all of it the stick would hunt
void add_drive_effect(const diagnosis::Effect& effect, double share, ConvertedModel& to);

}  // namespace stillhand::close_the_loop
