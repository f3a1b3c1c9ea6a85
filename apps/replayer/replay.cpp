// SPDX-License-Identifier: Apache-2.0
#include "replayer/replay.hpp"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <set>

#include "contract/config_error.hpp"
#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "recording/core/same_definition.hpp"
#include "recording/qos_texts.hpp"
#include "replayer/keyboard.hpp"
#include "replayer/player.hpp"
#include "replayer/remote.hpp"
#include "runtime/clock.hpp"
#include "runtime/playback.hpp"

namespace stillhand::replayer {

using recording::Channel;
using recording::ChannelId;

namespace {

constexpr std::int64_t kArrow_ns = 5 * runtime::kNsPerSecond;
constexpr std::int64_t kTellInterval_ns = runtime::kNsPerSecond / 4;
constexpr std::int64_t kStatusInterval_ns = runtime::kNsPerSecond / 10;
constexpr std::int64_t kMatchPoll_ns = 10'000'000;
constexpr std::int64_t kAcknowledge_ns = 2 * runtime::kNsPerSecond;

/// Recorded channel to writer on the bus.
struct Route {
  std::string topic;
  std::size_t writer;
};

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

struct Plan {
  std::map<ChannelId, Route> routes;
  std::vector<ChannelId> wanted;
  std::vector<ChannelId> latched;
};

Plan plan_routes(const ReplayOptions& options, const recording::McapReader& reader,
                 runtime::Playback& playback) {
  Plan plan;
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
    throw ConfigError(options.file, refused.empty() ? "no topic that matches" : *refused.begin(),
                      "a recording with topics to play");
  }
  for (const std::string& each : refused) std::fprintf(stderr, "not played: %s\n", each.c_str());
  return plan;
}

/// Every writer of the topic: each is found by itself.
bool has_readers(const std::string& topic, const Plan& plan, const runtime::Playback& playback) {
  return std::ranges::all_of(plan.routes, [&](const auto& route) {
    return route.second.topic != topic || playback.matched(route.second.writer) > 0;
  });
}

void wait_for_readers(const ReplayOptions& options, const Plan& plan,
                      const runtime::Playback& playback, const runtime::Stop& stop) {
  const std::int64_t limit_ns = runtime::monotonic_ns() + options.wait_limit_ns;
  for (const std::string& topic : options.wait_for) {
    while (!has_readers(topic, plan, playback) && !stop.requested()) {
      if (runtime::monotonic_ns() > limit_ns) {
        throw std::runtime_error("--wait-for " + topic + ": nobody reads it on domain " +
                                 std::to_string(options.domain));
      }
      runtime::sleep_until_ns(runtime::monotonic_ns() + kMatchPoll_ns);
    }
  }
}

void obey(Key key, Player& player, bool& quit) {
  switch (key) {
    case Key::kPause:
      return player.set_paused(!player.paused());
    case Key::kBack:
      return player.seek(player.position_ns() - kArrow_ns);
    case Key::kForward:
      return player.seek(player.position_ns() + kArrow_ns);
    case Key::kStep:
      player.set_paused(true);
      return player.step_once();
    case Key::kFaster:
      return player.set_rate(player.rate().faster());
    case Key::kSlower:
      return player.set_rate(player.rate().slower());
    case Key::kLoopFrom:
      return player.loop_from_here();
    case Key::kLoopTo:
      return player.loop_to_here();
    case Key::kLoopOff:
      return player.loop_off();
    case Key::kQuit:
      quit = true;
      return;
  }
}

void tell_progress(const Player& player, std::uint64_t first_ns, std::uint64_t last_ns) {
  if (isatty(STDERR_FILENO) != 1) return;
  const auto seconds = [first_ns](std::int64_t at_ns) {
    return static_cast<double>(at_ns - static_cast<std::int64_t>(first_ns)) / 1e9;
  };
  std::fprintf(stderr, "\r\033[K%.2f of %.2f s  rate %s%s  %" PRIu64 " messages",
               seconds(player.position_ns()), seconds(static_cast<std::int64_t>(last_ns)),
               player.rate().text().c_str(), player.paused() ? "  paused" : "", player.released());
}

/// Log times to play, of a recording that has messages.
std::pair<std::uint64_t, std::uint64_t> span_of(const ReplayOptions& options,
                                                const recording::Statistics& totals) {
  const auto at = [&](const std::optional<std::int64_t>& since_start_ns, std::uint64_t otherwise) {
    if (!since_start_ns) return otherwise;
    return std::min(totals.start_time_ns + static_cast<std::uint64_t>(*since_start_ns),
                    totals.end_time_ns);
  };
  const std::uint64_t first_ns = at(options.start_ns, totals.start_time_ns);
  const std::uint64_t last_ns = at(options.end_ns, totals.end_time_ns);
  if (first_ns > last_ns) throw ConfigError("--start", "later than --end", "--start before --end");
  return {first_ns, last_ns};
}

}  // namespace

int run_replay(const ReplayOptions& options, runtime::Stop& stop) {
  recording::FileSource file(options.file);
  const recording::McapReader reader(file);
  if (!reader.status().ok()) {
    throw ConfigError(options.file, reader.status().text, "a recording (MCAP, version 0)");
  }
  if (reader.statistics().message_count == 0) {
    throw ConfigError(options.file, "no messages", "a recording with messages");
  }
  const auto [first_ns, last_ns] = span_of(options, reader.statistics());
  runtime::Playback playback(options.profiles, options.domain,
                             "stillhand-replay/" + std::to_string(getpid()));
  const Plan plan = plan_routes(options, reader, playback);
  for (const std::string& topic : options.wait_for) {
    if (std::ranges::none_of(plan.routes, [&](const auto& r) { return r.second.topic == topic; })) {
      throw ConfigError("--wait-for", topic, "a topic that is played");
    }
  }
  Remote remote(runtime::outsider("replay", options.domain, options.profiles, true),
                topics::kReplayCommand, topics::kReplayStatus);
  wait_for_readers(options, plan, playback, stop);

  std::uint64_t refused = 0;
  MessageSource source(file, plan.wanted, plan.latched);
  Player player(source, first_ns, last_ns, options.rate, options.loop,
                [&](const recording::HeldMessage& message, std::span<const std::byte> bytes) {
                  const auto id = static_cast<ChannelId>(message.channel);
                  if (!playback.write(plan.routes.at(id).writer, bytes)) ++refused;
                });
  {
    Keyboard keyboard(options.keyboard);
    player.begin(options.begin_paused);
    const Played played{options.file, reader.statistics().start_time_ns,
                        reader.statistics().end_time_ns};
    std::int64_t told_ns = 0;
    std::int64_t status_ns = 0;
    for (bool quit = false; !quit && !stop.requested();) {
      const std::optional<std::int64_t> idle_ns = player.step();
      if (!idle_ns) break;
      if (const auto key = keyboard.wait(std::max<std::int64_t>(*idle_ns, 0))) {
        obey(*key, player, quit);
      }
      if (const std::int64_t now_ns = runtime::monotonic_ns();
          now_ns - told_ns > kTellInterval_ns) {
        told_ns = now_ns;
        tell_progress(player, first_ns, last_ns);
      }
      obey(remote, player, played, quit);
      if (const std::int64_t now_ns = runtime::monotonic_ns();
          now_ns - status_ns >= kStatusInterval_ns) {
        status_ns = now_ns;
        tell_status(remote, player, played);
      }
    }
    if (remote.asked()) tell_last_status(remote, player, played);
  }
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  playback.wait_for_acknowledgments(kAcknowledge_ns);

  const recording::ReleaseErrors& errors = player.errors();
  std::printf("%" PRIu64 " messages of %zu channels played\n", player.released(),
              plan.routes.size());
  std::printf("release error: p50 %" PRId64 " us, p99 %" PRId64 " us, max %" PRId64
              " us; drift %+.3f us/s\n",
              errors.percentile_us(0.50), errors.percentile_us(0.99), errors.max_us(),
              errors.drift_us_s());
  if (player.held_up() > 0) {
    std::printf("held up by the machine %" PRIu64
                " times for more than 10 ms, and caught up at twice "
                "the rate\n",
                player.held_up());
  }
  const std::vector<std::string> damage = source.damage();
  for (const std::string& line : damage) std::fprintf(stderr, "damaged: %s\n", line.c_str());
  if (refused > 0) std::fprintf(stderr, "%" PRIu64 " messages were refused by DDS\n", refused);
  return damage.empty() && refused == 0 ? 0 : 1;
}

}  // namespace stillhand::replayer
