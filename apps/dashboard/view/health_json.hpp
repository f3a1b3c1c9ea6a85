// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "apps/dashboard/core/chain_health.hpp"
#include "apps/dashboard/feed/message_feed.hpp"
#include "apps/dashboard/view/view_json.hpp"

/// The health of the bus in the snapshot: topics, chain, alarms.
namespace stillhand::dashboard {

/// Each topic's rate, losses, lateness, jitter and latency.  @param now_ns  [ns] system clock
Json topics_json(const MessageFeed& feed, std::int64_t now_ns);
/// [us] edges of the bars in `jitter_counts` of a topic; all above the last is a bar of its own.
Json jitter_edges_us();
/// Latencies from the sensor on.
Json chain_json(const ChainHealth& chain);
/// Alarms that are raised or were not acknowledged, the worst first.
Json alarms_json(const MessageFeed& feed);

}  // namespace stillhand::dashboard
