// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "apps/dashboard/core/config.hpp"
#include "apps/dashboard/core/topic_health.hpp"
#include "idl/topics.hpp"

namespace stillhand::dashboard {

/// The catalogue in the order in which a fault is looked for: round the loop from the sensor on.
inline constexpr std::array kFeedTopics{
    &topics::kRawSample,      &topics::kSensed,          &topics::kMotorCommand,
    &topics::kRigTruth,       &topics::kPlatformCommand, &topics::kTrackingSample,
    &topics::kOperatorForce,  &topics::kPointer,         &topics::kServiceStatus,
    &topics::kTrialControl,   &topics::kTrialAssignment, &topics::kFeedthroughModel,
    &topics::kAugmentedModel, &topics::kEvent,           &topics::kClockQuestion,
    &topics::kClockAnswer,    &topics::kClockOffset,     &topics::kHostStatus,
    &topics::kSessionCommand, &topics::kSessionSources,  &topics::kPrompt,
    &topics::kAnswer};
static_assert(kFeedTopics.size() == topics::kCatalogue.size(),
              "a topic of the catalogue is missing in kFeedTopics: add it here");

/// What is expected of each of kFeedTopics, in their order.
std::vector<TopicPlan> topic_plans(const Config& config);

}  // namespace stillhand::dashboard
