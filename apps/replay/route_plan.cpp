// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/route_plan.hpp"

#include <algorithm>
#include <cstdio>
#include <set>

#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/core/messages/same_definition.hpp"
#include "services/recording/qos_texts.hpp"

namespace stillhand::replay {

using recording::Channel;

namespace {

std::string mapped(const ReplayOptions& options, const std::string& topic) {
  const auto found = options.remap.find(topic);
  return found == options.remap.end() ? topic : found->second;
}

/// Why a channel cannot be written, or "".
std::string refusal(const Channel& channel, const recording::McapReader& reader) {
  if (channel.message_encoding != recording::kMessageEncoding) {
    return "its messages are \"" + channel.message_encoding + "\", not CDR";
  }
  const auto schema = reader.schemas().find(channel.schema_id);
  if (schema == reader.schemas().end()) return "its type is not in the file";
  const std::string& type = schema->second.name;
  if (!runtime::Playback::knows(type)) return "its type " + type + " is not known here";
  const std::string_view text(reinterpret_cast<const char*>(schema->second.bytes.data()),
                              schema->second.bytes.size());
  const std::string_view ours = topics::idl_of(type);
  if (text == ours) return {};
  try {
    const std::string difference = recording::definition_difference(
        recording::parse_idl(text, "schema of " + type), recording::parse_idl(ours, "idl"), type);
    return difference.empty() ? "" : type + " is another version's: " + difference;
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
    if (const auto profile = playback.profile(std::string(topics::profile_of(row->pattern)))) {
      return *profile;
    }
  }
  runtime::WriterQos qos;
  qos.reliable = true;
  return qos;
}

/// What a late reader is owed after a seek: the last one of a state.
bool is_latched(const runtime::WriterQos& qos) {
  return qos.reliable && qos.durability != runtime::Durability::kVolatile && qos.depth == 1;
}

}  // namespace

void check_names(const ReplayOptions& options, const recording::McapReader& reader) {
  for (const auto& [recorded, written] : options.remap) {
    if (std::ranges::none_of(reader.channels(), [&name = recorded](const auto& channel) {
          return channel.second.topic == name;
        })) {
      throw ConfigError("--remap", "no topic " + recorded,
                        recording::one_of_topics(reader.channels()));
    }
    if (!options.topics.wants(recorded)) {
      throw ConfigError("--remap", recorded + ", which is not played",
                        "a topic that --topics and --block leave");
    }
  }
}

RoutePlan plan_routes(const ReplayOptions& options, const recording::McapReader& reader,
                      runtime::Playback& playback) {
  RoutePlan plan;
  std::set<std::string> refused;  // once for all writers of a topic
  for (const auto& [id, channel] : reader.channels()) {
    if (!options.topics.wants(channel.topic)) continue;
    if (const std::string why = refusal(channel, reader); !why.empty()) {
      refused.insert(channel.topic + ": " + why);
      continue;
    }
    const runtime::WriterQos qos = qos_for(channel, playback);
    const std::string topic = mapped(options, channel.topic);
    plan.routes[id] = {
        topic, playback.add_writer(topic, reader.schemas().at(channel.schema_id).name, qos)};
    plan.wanted.push_back(id);
    if (is_latched(qos)) plan.latched.push_back(id);
  }
  if (plan.wanted.empty()) {
    throw refused.empty()
        ? ConfigError("--topics and --block", "no topic that they leave",
                      recording::one_of_topics(reader.channels()))
        : ConfigError(options.file, *refused.begin(), "a recording with topics to play");
  }
  for (const std::string& each : refused) std::fprintf(stderr, "not played: %s\n", each.c_str());
  return plan;
}

}  // namespace stillhand::replay
