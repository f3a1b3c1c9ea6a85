// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "apps/recordings/open_recording.hpp"

namespace stillhand::recordings {

struct Ros2Bag {
  std::map<std::string, std::uint64_t> topics;  ///< [-] messages of each topic of the bag
  std::uint64_t unread = 0;                     ///< [-] messages that do not match their type
};

/// A session's recording as messages of ROS 2 in MCAP, with their definitions (`ros2msg`): what is
/// sensed, commanded and reported, README "ROS 2".  Frames are those of REP 103: x forward, y left,
/// z up; Stillhand's y is right.  Messages of a replay are left out.
/// @param out  a file of that name is replaced once the bag is complete
/// @throws ConfigError when the recording can't be read or has none of these topics;
///         std::runtime_error when the disk fails; Interrupted
Ros2Bag write_ros2_bag(const std::string& recording, const std::filesystem::path& out,
                       const Stopped& stopped = {});

}  // namespace stillhand::recordings
