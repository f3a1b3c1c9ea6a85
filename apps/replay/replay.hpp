// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/core/recording/play_clock.hpp"
#include "services/core/recording/topic_filter.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::replay {

struct ReplayOptions {
  std::string file;
  recording::TopicFilter topics;
  std::map<std::string, std::string> remap;  ///< recorded topic -> topic written
  std::vector<std::string> wait_for;         ///< topics as written: begin when each has a reader
  recording::PlayRate rate;
  std::optional<std::int64_t> start_ns;  ///< [ns] from the recording's first message
  std::optional<std::int64_t> end_ns;    ///< [ns] from the recording's first message
  bool loop = false;
  bool begin_paused = false;
  bool keyboard = false;
  std::int64_t wait_limit_ns = 0;  ///< [ns] patience for wait_for
  std::uint32_t domain = 0;
  std::filesystem::path profiles;
};

/// Plays a recording onto the bus.  @returns 0, or 1 when a message could not be written or lay in
/// a damaged part of the file  @throws ConfigError, runtime::BusError
int run_replay(const ReplayOptions& options, runtime::Stop& stop);

/// Sends one command to the replay of a domain: "play", "pause", "step", "stop", "loop-off",
/// "seek S", "rate R", "loop S S".  @returns 0 when it obeyed, 1 when it did not or none answered
/// @throws ConfigError for other words
int run_remote(const std::string& command, const ReplayOptions& options, runtime::Stop& stop);

}  // namespace stillhand::replay
