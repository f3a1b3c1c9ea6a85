// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "idl/model.h"
#include "services/cancellation/core/canceller.hpp"

namespace stillhand::cancellation {

CancellerInput from_idl(const stillhand_msgs::Sensed& sensed, bool enabled, bool permitted);

/// The filter for the control rate; whether it is sound is for the canceller to judge.
ControlRateModel from_idl(const stillhand_msgs::FeedthroughModel& message);

/// Augmented models are numbered from here on, so that a motor command tells them from identified
/// ones.
inline constexpr std::int32_t kFirstAugmentedModel = 1000;

/// As sent; whether it is sound is for the canceller to judge.
AugmentedModel from_idl(const stillhand_msgs::AugmentedModel& message);
/// @param model  within the sizes that a canceller takes; longer lists are cut off at the message's
stillhand_msgs::AugmentedModel to_idl(const AugmentedModel& model, std::int32_t number);

/// @param sensed  the sample answered: its tick and acquisition stamp travel on
/// @param model   number of the model in use, -1 none
stillhand_msgs::MotorCommand to_idl(const CancellerOutput& output, const CancellerInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model);

}  // namespace stillhand::cancellation
