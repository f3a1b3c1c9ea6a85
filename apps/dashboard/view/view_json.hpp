// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "apps/dashboard/core/timeline.hpp"
#include "apps/dashboard/feed/message_feed.hpp"

namespace stillhand::dashboard {

using Json = nlohmann::ordered_json;

/// [ms] since 1970, as a browser counts; null for never.
Json instant(std::int64_t at_ns);
/// null where it is not finite.
Json number(double value);
/// Microseconds.
inline double us(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

/// The catalogue as a graph: writers and readers of each topic, the counts of each reader, and
/// endpoints that cannot match.
Json graph_json(const MessageFeed& feed);
/// Eq. DB-7: what lateness costs, or `why` nothing can be said of the trial that runs.
Json cost_json(const MessageFeed& feed);
/// Eq. DB-6; null without a segment.
Json spectrum_json(const ForceRecord& record);
/// Trials and marks, in seconds from the beginning; `at_s` of a mark is an instant of /snapshot?at=
/// that holds it.
Json timeline_json(const Timeline& timeline);

}  // namespace stillhand::dashboard
