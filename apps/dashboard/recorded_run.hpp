// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "dashboard/message_feed.hpp"

namespace stillhand::dashboard {

/// Feeds a whole recording, as the bus would have been fed.
/// @returns [ns] arrival of its last message: the instant at which it is looked at
/// @throws ConfigError when it cannot be read; recorder::Interrupted when `stopped` says so
std::int64_t feed_recording(const std::string& file, MessageFeed& feed,
                            const std::function<bool()>& stopped);

}  // namespace stillhand::dashboard
