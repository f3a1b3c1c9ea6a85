// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "idl/model.h"
#include "services/core/identification/identifier.hpp"

namespace stillhand::identification {

/// @param number  of the model
/// @param trial   number of the pegged trial that it was identified from
stillhand_msgs::FeedthroughModel to_idl(const FeedthroughModel& model, std::int32_t number,
                                        std::int32_t trial);
/// The same; a failed identification becomes an unusable model that states the reason.
stillhand_msgs::FeedthroughModel to_idl(const Identification& outcome, std::int32_t number,
                                        std::int32_t trial);
/// Fit, control filter and held-out quality; what the topic does not carry stays 0.
FeedthroughModel from_idl(const stillhand_msgs::FeedthroughModel& message);

}  // namespace stillhand::identification
