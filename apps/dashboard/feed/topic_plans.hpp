// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "apps/dashboard/core/config.hpp"
#include "apps/dashboard/core/topic_health.hpp"
#include "idl/topics.hpp"

namespace stillhand::dashboard {

/// Where a fault is looked for first: round the loop from the sensor on.
inline constexpr std::array kLoopTopics{
    &topics::kRawSample,     &topics::kSensed,          &topics::kMotorCommand,
    &topics::kRigTruth,      &topics::kPlatformCommand, &topics::kTrackingSample,
    &topics::kOperatorForce, &topics::kPointer,         &topics::kServiceStatus};

/// The catalogue in the order in which a fault is looked for: kLoopTopics, then the others.
inline constexpr auto kFeedTopics = [] {
  auto list = topics::kCatalogue;
  auto end = std::ranges::copy(kLoopTopics, list.begin()).out;
  std::ranges::copy_if(topics::kCatalogue, end, [](const topics::Topic* topic) {
    return std::ranges::find(kLoopTopics, topic) == kLoopTopics.end();
  });
  return list;
}();

/// What is expected of each of kFeedTopics, in their order.
std::vector<TopicPlan> topic_plans(const Config& config);

}  // namespace stillhand::dashboard
