// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "idl/model.h"
#include "services/identification/core/identifier.hpp"

namespace stillhand::identification {

/// @param number  of the model  @param trial  the pegged trial behind it
stillhand_msgs::FeedthroughModel to_idl(const FeedthroughModel& model, std::int32_t number,
                                        std::int32_t trial);
/// Identification failed: an unusable model that says why.
stillhand_msgs::FeedthroughModel failure_to_idl(const std::string& why, std::int32_t number,
                                                std::int32_t trial);
/// Fit, control filter and held-out quality; what the topic does not carry stays 0.
FeedthroughModel from_idl(const stillhand_msgs::FeedthroughModel& message);

}  // namespace stillhand::identification
