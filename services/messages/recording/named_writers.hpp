// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "services/core/recording/mcap/mcap_reader.hpp"

namespace stillhand::recording {

/// McapReader::for_each_message() without what strangers wrote.  The recorder keeps the messages of
/// every writer, a channel for each.  Of a topic with one writer, only those of the participant
/// count that the newest session_sources names; it comes before the first sample.  A recording
/// without one, or a channel without its writer, is read whole.
Status for_each_session_message(McapReader& reader, const MessageFilter& filter,
                                const std::function<bool(const MessageView&)>& take);

}  // namespace stillhand::recording
