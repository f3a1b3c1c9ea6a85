// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "apps/replay/replay.hpp"
#include "services/bus/playback.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"

namespace stillhand::replay {

/// Recorded channel to writer on the bus.
struct Route {
  std::string topic;   ///< as written
  std::size_t writer;  ///< of the playback
  bool foreign;        ///< idl/ does not define its type: its readers do not know a replay's mark
};

/// The channels that are played, and their writers.
struct RoutePlan {
  std::map<recording::ChannelId, Route> routes;
  std::vector<recording::ChannelId> wanted;
  std::vector<recording::ChannelId> latched;  ///< of these: a late reader gets the last message
};

/// Names of topics against a recording, before anything is on the bus.
/// @throws ConfigError for a --remap that would be without effect
void check_names(const ReplayOptions& options, const recording::McapReader& reader);

/// Makes a writer for each channel that is wanted and can be played; says which cannot.
/// @throws ConfigError when none is left, runtime::BusError
RoutePlan plan_routes(const ReplayOptions& options, const recording::McapReader& reader,
                      runtime::Playback& playback);

}  // namespace stillhand::replay
