// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/info.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "idl/topics.hpp"
#include "services/core/recording/mcap/compression.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"

namespace stillhand::recordings {
namespace {

// One channel on the way: ticks are counted for each rig by itself.
struct Counted {
  TopicInfo info;
  bool has_ticks = false;
  std::map<std::uint32_t, Tick> newest_ticks;

  void take(const recording::MessageView& message) {
    const std::uint64_t time_ns = message.log_time_ns;
    info.first_ns = info.messages == 0 ? time_ns : std::min(info.first_ns, time_ns);
    info.last_ns = std::max(info.last_ns, time_ns);
    ++info.messages;
    if (!has_ticks) return;
    const recording::SampleHead head = recording::sample_head(message.bytes);
    if (head.tick < 0) return;
    const auto [newest, first] = newest_ticks.try_emplace(head.rig, head.tick);
    if (!first && head.tick > newest->second) *info.lost_ticks += head.tick - newest->second - 1;
    newest->second = std::max(newest->second, head.tick);
  }
};

std::map<recording::ChannelId, Counted> channels_of(const recording::McapReader& reader) {
  std::map<recording::ChannelId, Counted> channels;
  for (const auto& [id, channel] : reader.channels()) {
    Counted& counted = channels[id];
    counted.info.topic = channel.topic;
    counted.info.encoding = channel.message_encoding;
    counted.info.channels.push_back(channel.metadata);
    const auto schema = reader.schemas().find(channel.schema_id);
    if (schema != reader.schemas().end()) {
      counted.info.type = schema->second.name;
      counted.info.schema_encoding = schema->second.encoding;
    }
    const topics::Topic* known = topics::find(channel.topic);
    counted.has_ticks = known != nullptr && known->pattern == topics::Pattern::kStream1khz &&
                        channel.message_encoding == recording::kMessageEncoding;
    if (counted.has_ticks) counted.info.lost_ticks = 0;
  }
  return channels;
}

void add(TopicInfo& topic, const TopicInfo& channel) {
  topic.channels.insert(topic.channels.end(), channel.channels.begin(), channel.channels.end());
  if (channel.messages == 0) return;
  topic.first_ns =
      topic.messages == 0 ? channel.first_ns : std::min(topic.first_ns, channel.first_ns);
  topic.last_ns = std::max(topic.last_ns, channel.last_ns);
  topic.messages += channel.messages;
  if (channel.lost_ticks) *topic.lost_ticks += *channel.lost_ticks;
}

// Channels of a topic and type together, by name.
std::vector<TopicInfo> topics_of(const std::map<recording::ChannelId, Counted>& channels) {
  std::map<std::array<std::string, 4>, TopicInfo> topics;
  for (const auto& [id, counted] : channels) {
    const TopicInfo& info = counted.info;
    const auto [topic, fresh] =
        topics.try_emplace({info.topic, info.type, info.encoding, info.schema_encoding}, info);
    if (!fresh) add(topic->second, info);
  }
  std::vector<TopicInfo> list;
  for (auto& [key, topic] : topics) {
    if (topic.messages > 1 && topic.last_ns > topic.first_ns) {
      topic.rate_hz = static_cast<double>(topic.messages - 1) * 1e9 /
                      static_cast<double>(topic.last_ns - topic.first_ns);
    }
    list.push_back(std::move(topic));
  }
  return list;
}

std::string packing_name(recording::Compression compression) {
  const std::string_view name = recording::compression_name(compression);
  return name.empty() ? "none" : std::string(name);
}

}  // namespace

RecordingInfo info_of(OpenRecording& recording) {
  recording::McapReader& reader = recording.reader;
  auto channels = channels_of(reader);
  RecordingInfo info;
  check(reader.verify([&](const recording::MessageView& message) {
    channels.at(message.channel.id).take(message);
    const std::uint64_t time_ns = message.log_time_ns;
    info.start_ns = info.messages == 0 ? time_ns : std::min(info.start_ns, time_ns);
    info.end_ns = std::max(info.end_ns, time_ns);
    ++info.messages;
  }));
  info.path = recording.path;
  info.bytes = recording.source.size();
  info.program = reader.library();
  info.profile = reader.profile();
  info.being_written = recording.source.being_written();
  info.whole = reader.damage().empty() && !info.being_written;
  info.chunks = reader.statistics().chunk_count;
  info.attachments = reader.statistics().attachment_count;
  for (const auto compression : reader.compressions()) {
    info.packings.push_back(packing_name(compression));
  }
  info.topics = topics_of(channels);
  info.metadata = reader.metadata();
  info.damage = reader.damage();
  info.lost_bytes = reader.lost_bytes();
  info.clock_steps = reader.clock_steps();
  return info;
}

}  // namespace stillhand::recordings
