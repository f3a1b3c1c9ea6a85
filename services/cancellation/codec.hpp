// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/core/canceller.hpp"
#include "services/cancellation/core/trial_arming.hpp"
#include "services/mitigation/core/part.hpp"
#include "services/mitigation/mitigation.hpp"

namespace stillhand::cancellation {

CancellerInput from_idl(const stillhand_msgs::Sensed& sensed, bool enabled, bool permitted);

Assignment from_idl(const stillhand_msgs::TrialAssignment& message);
/// As sent; mitigation::recipe_of() judges whether they are sound.
std::vector<mitigation::Part> parts_of(const stillhand_msgs::TrialAssignment& message);

/// The filter for the control rate; check_model() judges whether it is sound.
/// The model at the canceller's rate: the fit where the model runs below 1 kHz.
signal::DifferenceModel from_idl(const stillhand_msgs::FeedthroughModel& message,
                                 const SamplingConfig& sampling = {});

/// Models of the topic stillhand/augmented_model are numbered from here on, so that the number in a
/// motor command distinguishes them from identified ones.
inline constexpr std::int32_t kFirstControlModel = 1000;

/// As sent; check_model() judges whether it is sound.
ControlModel from_idl(const stillhand_msgs::AugmentedModel& message);
/// @param model  within the sizes that the canceller takes
stillhand_msgs::AugmentedModel to_idl(const ControlModel& model, std::int32_t number);

/// @param sensed  the sample answered: its tick and acquisition stamp travel on
/// @param model   number of the model in use, -1 none
stillhand_msgs::MotorCommand to_idl(const CancellerOutput& output, const CancellerInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model);
/// The force, the weights and the command of a mitigation in place of the canceller's.
/// @param canceller  answer of the canceller to the same sample; its prediction is recorded
/// @param input      of the mitigation
/// @param trial      whose mitigation it is
stillhand_msgs::MotorCommand to_idl(const mitigation::MitigationOutput& output,
                                    const CancellerOutput& canceller, const CancellerInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model,
                                    std::int64_t trial);

}  // namespace stillhand::cancellation
