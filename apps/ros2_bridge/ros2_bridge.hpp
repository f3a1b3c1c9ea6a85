// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/core/recording/topic_filter.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::ros2_bridge {

struct BridgeOptions {
  std::vector<std::string> topics;     ///< patterns of topics of the session; empty: all
  std::vector<std::string> addresses;  ///< on which ROS 2 is reached, besides the loopback
  bool replay = false;                 ///< of a replay alone, in the place of a session
  std::uint32_t domain = 0;
  std::uint32_t ros_domain = 0;
  std::filesystem::path profiles;
  std::filesystem::path security;  ///< of the session's domain, see runtime::Bus::Options
};

/// Publishes what a session says as messages of ROS 2 until a stop is requested, README.  Prints
/// each topic, and how many readers it has whenever that changes.
/// @returns 0, or 1 when a message was left out  @throws ConfigError, runtime::BusError
int run_bridge(const BridgeOptions& options, runtime::Stop& stop);

}  // namespace stillhand::ros2_bridge
