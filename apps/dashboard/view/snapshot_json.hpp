// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/dashboard/feed/message_feed.hpp"
#include "apps/dashboard/feed/rigs.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/display/tracking_display.hpp"

namespace stillhand::dashboard {

/// Values on the page that do not come from the feed.
struct Surroundings {
  std::string mode;  ///< "live" or "recording"
  std::string file;  ///< of a recording
  std::uint32_t domain = 0;
  double motor_limit_n = 0.0;  ///< [N] narrower of the canceller's and the drive's
  display::TrackingDisplay::Config screen;
  std::uint64_t dropped = 0;  ///< messages that came while the queue was full
  std::vector<std::string> trouble;
  double cpu_share = 0.0;        ///< [-] of one core, by this process
  std::size_t clients = 0;       ///< that listen
  std::vector<RigSummary> rigs;  ///< of a bus
  bool actions = false;          ///< requests to the session are possible
};

/// Parts that not every frame needs.
struct Parts {
  bool graph = true;     ///< sent twice a second
  bool spectrum = true;  ///< takes milliseconds
};

/// Everything the page shows at one instant, README "HTTP".
/// @param after  traces behind this tick, -1: all that are kept
std::string snapshot_json(const MessageFeed& feed, const Surroundings& around, std::int64_t now_ns,
                          Tick after, Parts parts = {});

}  // namespace stillhand::dashboard
