// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/core/identification/identifier.hpp"

namespace stillhand::identification {

/// Newest "stillhand model" format that this program writes and reads.
inline constexpr int kModelFormatVersion = 1;

/// JSON text of a model; README "Model file".  Numbers keep every bit.
/// @throws stillhand::ConfigError when the model itself would be refused by parse_model().
std::string model_json(const FeedthroughModel& model);

/// Reads it back.  @param origin  what to call the text in messages, for example its path
/// @throws stillhand::ConfigError naming line and column of a syntax error, or the entry that is
/// missing, has the wrong type or size, isn't finite, makes the model unstable, or a newer version.
FeedthroughModel parse_model(std::string_view json, const std::string& origin);

}  // namespace stillhand::identification
