// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/replay.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>

#include "apps/replay/keyboard.hpp"
#include "apps/replay/player.hpp"
#include "apps/replay/remote.hpp"
#include "apps/replay/route_plan.hpp"
#include "idl/topics.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/core/mcap/mcap_loss.hpp"
#include "services/runtime/bus/playback.hpp"
#include "services/runtime/process/clock.hpp"

namespace stillhand::replay {

using recording::ChannelId;

namespace {

constexpr std::int64_t kArrow_ns = 5 * runtime::kNsPerSecond;
constexpr std::int64_t kTellInterval_ns = runtime::kNsPerSecond / 4;
constexpr std::int64_t kStatusInterval_ns = runtime::kNsPerSecond / 10;
constexpr std::int64_t kMatchPoll_ns = 10'000'000;
constexpr std::int64_t kAcknowledge_ns = 2 * runtime::kNsPerSecond;

/// Every writer of the topic: each is found by itself.
bool has_readers(const std::string& topic, const RoutePlan& plan,
                 const runtime::Playback& playback) {
  return std::ranges::all_of(plan.routes, [&](const auto& route) {
    return route.second.topic != topic || playback.matched(route.second.writer) > 0;
  });
}

void wait_for_readers(const ReplayOptions& options, const RoutePlan& plan,
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

/// "12.5", "0.000000001"
std::string seconds(std::uint64_t ns) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.9f", static_cast<double>(ns) / 1e9);
  std::string trimmed = text.data();
  trimmed.erase(trimmed.find_last_not_of('0') + 1);
  if (trimmed.back() == '.') trimmed.pop_back();
  return trimmed;
}

/// Log times to play, of a recording that has messages.
std::pair<std::uint64_t, std::uint64_t> span_of(const ReplayOptions& options,
                                                const recording::Statistics& totals) {
  const std::uint64_t length_ns = totals.end_time_ns - totals.start_time_ns;
  const auto start_ns = static_cast<std::uint64_t>(options.start_ns.value_or(0));
  const std::uint64_t end_ns =
      options.end_ns ? std::min(static_cast<std::uint64_t>(*options.end_ns), length_ns) : length_ns;
  if (start_ns > length_ns) {
    throw ConfigError("--start", seconds(start_ns) + " s",
                      "at most " + seconds(length_ns) + " s, the length of " + options.file);
  }
  if (start_ns > end_ns) throw ConfigError("--start", "later than --end", "--start before --end");
  return {totals.start_time_ns + start_ns, totals.start_time_ns + end_ns};
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
  check_names(options, reader);
  runtime::Playback playback(options.profiles, options.domain,
                             "stillhand-replay/" + std::to_string(getpid()));
  const RoutePlan plan = plan_routes(options, reader, playback);
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
  const std::vector<recording::Damage> damage = source.damage();
  const std::string loss =
      recording::loss_line(options.file, damage, std::nullopt, file.being_written());
  if (!loss.empty()) std::fprintf(stderr, "stillhand: %s\n", loss.c_str());
  if (refused > 0) std::fprintf(stderr, "%" PRIu64 " messages were refused by DDS\n", refused);
  return recording::lost_bytes(damage) == 0 && refused == 0 ? 0 : 1;
}

}  // namespace stillhand::replay
