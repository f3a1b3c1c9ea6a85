// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "idl/session.h"
#include "services/core/display/answering.hpp"
#include "services/core/display/command_in_use.hpp"
#include "services/core/display/prompt.hpp"
#include "services/core/display/tracking_display.hpp"

namespace stillhand::display {

/// @param off  by CommandInUse
TrackingInput from_idl(const stillhand_msgs::Sensed& sensed, const TakenOff& off = {});
TakenOff from_idl(const stillhand_msgs::MotorCommand& command);
/// @param command  tick of the motor command whose angle was taken off, -1 none
stillhand_msgs::TrackingSample to_idl(const TrackingSample& sample, Tick tick, std::int64_t trial,
                                      Tick command = -1);
/// A kind that this version does not know is kNothing; steps out of range take no answer.
Prompt from_idl(const stillhand_msgs::Prompt& prompt);
stillhand_msgs::Answer to_idl(const Answering::Answer& answer);

}  // namespace stillhand::display
