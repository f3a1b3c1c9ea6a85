// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/dashboard/feed/message_feed.hpp"
#include "apps/dashboard/view/view_json.hpp"

/// What runs, in the snapshot.  @param now_ns  [ns] system clock
namespace stillhand::dashboard {

/// The processes of a session: newest status, counts of misses, use of the machine.
Json services_json(const MessageFeed& feed, std::int64_t now_ns);
/// Each process reports its host; the newest report counts.
Json hosts_json(const MessageFeed& feed);
/// Each `stillhand record` on the bus.
Json recorders_json(const MessageFeed& feed, std::int64_t now_ns);
/// Each process's clock against the experiment's.
Json clocks_json(const MessageFeed& feed);

}  // namespace stillhand::dashboard
