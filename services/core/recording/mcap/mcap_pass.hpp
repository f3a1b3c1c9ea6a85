// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/core/recording/mcap/clock_steps.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"

namespace stillhand::recording {

// A walk over all pieces.  Each pass looks up a channel once, by number.
struct McapReader::Pass {
  struct Topic {
    const Channel* channel = nullptr;
    const Schema* schema = nullptr;
    bool wanted = false;
    bool stream = false;  // of 1 kHz samples, not replayed
  };
  const MessageFilter& filter;
  const std::function<bool(const MessageView&)>& take;
  std::vector<Topic> topics = {};
  bool stopped = false;
  std::uint64_t unknown_bytes = 0;  // messages without a channel in this piece
  ClockStepFinder* finder = nullptr;
  std::size_t step = 0;                         // steps of the clock ahead of the message
  std::uint64_t shift_ns = 0;                   // their sum, modulo 2^64
  std::uint64_t message = 0;                    // its number in this piece
  std::optional<std::uint64_t> newest_ns = {};  // straight time of the one before it in this piece

  static bool is_stream(const Channel& channel) {
    const auto profile = channel.metadata.find("qos_profile");
    return profile != channel.metadata.end() &&
           (profile->second == "stream_1khz" || profile->second == "control_loop") &&
           !channel.metadata.contains("replayed");
  }
  const Topic& topic(const McapReader& reader, ChannelId id) {
    if (id >= topics.size()) topics.resize(std::size_t{id} + 1);
    Topic& topic = topics[id];
    if (topic.channel == nullptr) {
      const auto channel = reader.channels_.find(id);
      if (channel != reader.channels_.end()) {
        topic.channel = &channel->second;
        const auto schema = reader.schemas_.find(topic.channel->schema_id);
        topic.schema = schema == reader.schemas_.end() ? nullptr : &schema->second;
        topic.stream = is_stream(*topic.channel);
        topic.wanted =
            filter.topics.empty() ||
            std::ranges::find(filter.topics, topic.channel->topic) != filter.topics.end();
      }
    }
    return topic;
  }
};

}  // namespace stillhand::recording
