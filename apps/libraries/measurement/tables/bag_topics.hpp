// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/messages/message_columns.hpp"

namespace stillhand::measurement {

/// A topic of an MCAP file whose messages are decoded.
struct BagTopic {
  std::string name;
  std::string type;
  std::unique_ptr<recording::IdlSchema> schema;  ///< outlives `columns`
  std::unique_ptr<recording::MessageColumns> columns;
  std::uint64_t messages = 0;
  /// Columns of header.stamp, seconds and nanoseconds.
  std::optional<std::pair<std::size_t, std::size_t>> stamp = {};
};

/// The topics of a file, by channel.  Channels of one topic and type share an entry.
struct BagTopics {
  std::vector<std::unique_ptr<BagTopic>> topics;
  std::map<recording::ChannelId, BagTopic*> by_channel;
  std::vector<std::string> left_out;  ///< a topic and why, each
};

/// Reads the definitions, and the lengths of lists where there are lists.
BagTopics find_bag_topics(recording::McapReader& reader, const std::string& path);

/// Unit of a member of a ROS type whose comments state it in words: sensor_msgs/Imu,
/// geometry_msgs/Wrench, Accel, Twist; empty: unknown.  Source: REP 103, the types' comments.
std::string ros_unit(const std::string& type, const std::string& member);

}  // namespace stillhand::measurement
