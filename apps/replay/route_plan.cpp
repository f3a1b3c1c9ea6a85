// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/route_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "idl/cdr.hpp"
#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/bus/recording/qos_texts.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/same_definition.hpp"

namespace stillhand::replay {

using recording::Channel;

namespace {

std::string mapped(const ReplayOptions& options, const std::string& topic) {
  const auto found = options.remap.find(topic);
  return found == options.remap.end() ? topic : found->second;
}

/// @returns why a channel cannot be played, or ""
/// @param topic  as written
std::string refusal(const Channel& channel, const std::string& topic,
                    const recording::McapReader& reader) {
  if (channel.message_encoding != recording::kMessageEncoding) {
    return fmt::format("its message encoding is \"{}\", not CDR", channel.message_encoding);
  }
  const auto schema = reader.schemas().find(channel.schema_id);
  if (schema == reader.schemas().end()) return "its type is not in the file";
  const std::string& type = schema->second.name;
  if (!runtime::Playback::knows(type)) {
    // Bytes go out as they came if the recording has what their writer offered, but not to the
    // session's processes.
    const auto qos = recording::qos_of(channel.metadata);
    if (!qos || topics::find(topic) != nullptr) {
      return fmt::format("its type {} is unknown to this program", type);
    }
    return runtime::Playback::offers(*qos) ? "" : "its messages are XCDR 2, for Fast DDS 3 alone";
  }
  const std::string_view text(reinterpret_cast<const char*>(schema->second.bytes.data()),
                              schema->second.bytes.size());
  const std::string_view ours = topics::idl_of(type);
  if (text == ours) return {};
  try {
    const std::string difference = recording::definition_difference(
        recording::parse_idl(text, "schema of " + type), recording::parse_idl(ours, "idl"), type,
        has_earlier_form(type));
    return difference.empty()
               ? ""
               : fmt::format("this program has another definition of {}: {}", type, difference);
  } catch (const ConfigError& error) {
    return error.what();
  }
}

runtime::WriterQos qos_for(const Channel& channel, const runtime::Playback& playback) {
  if (const auto recorded = recording::qos_of(channel.metadata)) return *recorded;
  // Recordings of a session name the profile.
  if (const auto name = channel.metadata.find("qos_profile"); name != channel.metadata.end()) {
    if (const auto profile = playback.profile(name->second)) return *profile;
  }
  if (const topics::Topic* row = topics::find(channel.topic); row != nullptr) {
    if (const auto profile = playback.profile(std::string(topics::profile_of(*row)))) {
      return *profile;
    }
  }
  runtime::WriterQos qos;
  qos.reliable = true;
  return qos;
}

/// A state: a late reader gets its last message, also after a seek.
bool is_latched(const runtime::WriterQos& qos) {
  return qos.reliable && qos.durability != runtime::Durability::kVolatile && qos.depth == 1;
}

}  // namespace

void check_names(const ReplayOptions& options, const recording::McapReader& reader) {
  recording::require_each_matches(options.topics.allow, "--topics", reader.channels());
  // A mistyped name would play what was to be held back, a command to the motor for one.
  recording::require_each_matches(options.topics.block, "--block", reader.channels());
  for (const auto& [recorded, written] : options.remap) {
    if (std::ranges::none_of(reader.channels(), [&name = recorded](const auto& channel) {
          return channel.second.topic == name;
        })) {
      throw ConfigError("--remap", "no topic " + recorded,
                        recording::one_of_topics(reader.channels()));
    }
    if (!options.topics.wants(recorded)) {
      throw ConfigError("--remap", recorded + ", which is not played",
                        "a topic that --topics and --block select");
    }
  }
}

RoutePlan plan_routes(const ReplayOptions& options, const recording::McapReader& reader,
                      runtime::Playback& playback) {
  RoutePlan plan;
  std::set<std::string> refused;  // once for all writers of a topic
  for (const auto& [id, channel] : reader.channels()) {
    if (!options.topics.wants(channel.topic)) continue;
    const std::string topic = mapped(options, channel.topic);
    if (const std::string why = refusal(channel, topic, reader); !why.empty()) {
      refused.insert(channel.topic + ": " + why);
      continue;
    }
    const runtime::WriterQos qos = qos_for(channel, playback);
    const std::string& type = reader.schemas().at(channel.schema_id).name;
    plan.routes[id] = {topic, playback.add_writer(topic, type, qos),
                       !runtime::Playback::knows(type)};
    plan.wanted.push_back(id);
    if (is_latched(qos)) plan.latched.push_back(id);
  }
  if (plan.wanted.empty()) {
    throw refused.empty()
        ? ConfigError("--topics and --block", "no topic selected",
                      recording::one_of_topics(reader.channels()))
        : ConfigError(options.file, *refused.begin(), "a recording with topics to play");
  }
  for (const std::string& each : refused) fmt::print(stderr, "not played: {}\n", each);
  return plan;
}

}  // namespace stillhand::replay
