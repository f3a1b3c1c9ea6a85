// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "services/core/cancellation/part.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/cancellation/trial_arming.hpp"

namespace stillhand::cancellation {

CountermeasureInput from_idl(const stillhand_msgs::Sensed& sensed, bool enabled, bool permitted);

Assignment from_idl(const stillhand_msgs::TrialAssignment& message);
/// As sent; recipe_of() judges whether they are sound.
std::vector<Part> parts_of(const stillhand_msgs::TrialAssignment& message);

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
/// @param trial   whose own parts run, 0 none
stillhand_msgs::MotorCommand to_idl(const CountermeasureOutput& output,
                                    const CountermeasureInput& input,
                                    const stillhand_msgs::Sensed& sensed, std::int32_t model,
                                    std::int64_t trial);

}  // namespace stillhand::cancellation
