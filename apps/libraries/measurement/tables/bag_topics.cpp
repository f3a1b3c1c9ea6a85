// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/bag_topics.hpp"

#include <algorithm>
#include <array>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/schema_types.hpp"

namespace stillhand::measurement {
namespace {

void add_channel(const recording::McapReader& reader, const recording::Channel& channel,
                 const std::string& path, BagTopics& out) {
  if (channel.message_encoding != recording::kMessageEncoding) {
    throw ConfigError(channel.topic, "messages in '" + channel.message_encoding + "'",
                      "messages in 'cdr'");
  }
  const auto schema = reader.schemas().find(channel.schema_id);
  if (schema == reader.schemas().end()) {
    throw ConfigError(channel.topic, "no schema in the recording", "a schema");
  }
  const auto counts = reader.statistics().channel_message_counts;
  const auto count = counts.find(channel.id);
  const std::uint64_t messages = count == counts.end() ? 0 : count->second;
  for (const auto& topic : out.topics) {
    if (topic->name != channel.topic || topic->type != schema->second.name) continue;
    out.by_channel[channel.id] = topic.get();
    topic->messages += messages;
    return;
  }
  auto topic = std::make_unique<BagTopic>();
  topic->name = channel.topic;
  topic->type = schema->second.name;
  topic->messages = messages;
  topic->schema = std::make_unique<recording::IdlSchema>(recording::parse_schema(
      schema->second, path + ", schema " + std::to_string(channel.schema_id)));
  topic->columns = std::make_unique<recording::MessageColumns>(*topic->schema,
                                                               *topic->schema->find(topic->type));
  if (!topic->columns->trouble().empty()) {
    throw ConfigError(channel.topic, topic->columns->trouble(), "messages that are decoded");
  }
  out.by_channel[channel.id] = topic.get();
  out.topics.push_back(std::move(topic));
}

void learn_lists(recording::McapReader& reader, BagTopics& bag) {
  recording::MessageFilter filter;
  for (const auto& topic : bag.topics) {
    if (topic->columns->has_lists()) filter.topics.push_back(topic->name);
  }
  if (filter.topics.empty()) return;
  // A failure shows again when the values are read.
  (void)reader.for_each_message(filter, [&](const recording::MessageView& message) {
    const auto found = bag.by_channel.find(message.channel.id);
    if (found != bag.by_channel.end()) (void)found->second->columns->learn(message.bytes);
    return true;
  });
}

void find_stamp(BagTopic& topic) {
  const auto& columns = topic.columns->columns();
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(
        std::ranges::find(columns, name, &recording::MessageColumn::name) - columns.begin());
  };
  const std::size_t seconds = at("header.stamp.sec");
  const std::size_t nanoseconds = at("header.stamp.nanosec");
  if (seconds < columns.size() && nanoseconds < columns.size()) {
    topic.stamp = {seconds, nanoseconds};
  }
}

}  // namespace

BagTopics find_bag_topics(recording::McapReader& reader, const std::string& path) {
  BagTopics out;
  for (const auto& [id, channel] : reader.channels()) {
    try {
      add_channel(reader, channel, path, out);
    } catch (const ConfigError& error) {
      out.left_out.emplace_back(error.what());
    }
  }
  learn_lists(reader, out);
  std::erase_if(out.topics, [&](const auto& topic) {
    if (topic->columns->trouble().empty()) return false;
    out.left_out.push_back(topic->name + ": " + topic->columns->trouble());
    std::erase_if(out.by_channel, [&](const auto& entry) { return entry.second == topic.get(); });
    return true;
  });
  for (const auto& topic : out.topics) {
    topic->columns->settle();
    find_stamp(*topic);
  }
  return out;
}

std::string ros_unit(const std::string& type, const std::string& member) {
  struct Known {
    std::string_view type;
    std::string_view member;
    const char* unit;
  };
  constexpr std::array<Known, 8> kKnown{{{"sensor_msgs/msg/Imu", "linear_acceleration.", "m/s^2"},
                                         {"sensor_msgs/msg/Imu", "angular_velocity.", "rad/s"},
                                         {"geometry_msgs/msg/Wrench", "force.", "N"},
                                         {"geometry_msgs/msg/Wrench", "torque.", "N.m"},
                                         {"geometry_msgs/msg/Accel", "linear.", "m/s^2"},
                                         {"geometry_msgs/msg/Accel", "angular.", "rad/s^2"},
                                         {"geometry_msgs/msg/Twist", "linear.", "m/s"},
                                         {"geometry_msgs/msg/Twist", "angular.", "rad/s"}}};
  for (const Known& known : kKnown) {
    const std::size_t at = member.find(known.member);
    const bool begins = at == 0 || (at != std::string::npos && member[at - 1] == '.');
    if (type.starts_with(known.type) && begins) return known.unit;
  }
  return {};
}

}  // namespace stillhand::measurement
