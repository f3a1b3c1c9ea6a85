// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/libraries/ros2/definitions.hpp"

namespace stillhand::ros2 {

struct Message {
  std::string topic;           ///< name in ROS 2, with the number of the rig
  const Definition* type;      ///< never null; lives as long as the program
  std::vector<std::byte> cdr;  ///< plain CDR (XCDR 1) with its encapsulation header
};

/// Topics of a session that become messages of ROS 2.
const std::vector<std::string_view>& sources();

/// One message of a session as messages of ROS 2, README.  Frames are those of REP 103: x forward,
/// y left, z up; Stillhand's y is right.  Pure.
/// @param bytes    CDR with its encapsulation header
/// @param time_ns  [ns] stamp of the headers
/// @returns nothing when the bytes are no message of this topic; empty for a topic that is none of
/// sources()
std::optional<std::vector<Message>> converted(std::string_view topic,
                                              std::span<const std::byte> bytes,
                                              std::uint64_t time_ns);

/// The name of a type on DDS: "sensor_msgs::msg::dds_::Imu_" of sensor_msgs/msg/Imu.
std::string dds_type(const Definition& type);

}  // namespace stillhand::ros2
