// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/replay.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>

#include "apps/replay/keyboard.hpp"
#include "apps/replay/player.hpp"
#include "apps/replay/remote.hpp"
#include "apps/replay/route_plan.hpp"
#include "idl/topics.hpp"
#include "services/bus/playback.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::replay {

using recording::ChannelId;

namespace {

constexpr std::int64_t kArrow_ns = 5 * runtime::kNsPerSecond;
constexpr std::int64_t kPrintInterval_ns = runtime::kNsPerSecond / 4;
constexpr std::int64_t kStatusInterval_ns = runtime::kNsPerSecond / 10;
constexpr std::int64_t kMatchPoll_ns = 10'000'000;
constexpr std::int64_t kTooLate_us = 100'000;  // for half of the messages
// Peers announce themselves every 0.1 s at their start and every 0.5 s later (qos/profiles.xml).
constexpr std::int64_t kSettled_ns = 6 * runtime::kNsPerSecond / 10;
constexpr std::int64_t kAcknowledge_ns = 2 * runtime::kNsPerSecond;

/// Every writer of the topic has a reader: discovery finds each writer separately.
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
        throw std::runtime_error(fmt::format("--wait-for {}: no reader on domain {} within {:g} s",
                                             topic, options.domain,
                                             static_cast<double>(options.wait_limit_ns) / kNsPerS));
      }
      runtime::sleep_until_ns(runtime::monotonic_ns() + kMatchPoll_ns);
    }
  }
}

// Discovery takes a moment: the first messages would go out to nobody.  Waits until no writer has
// found a further reader for as long as peers take to announce themselves; 5 s at most.
void wait_for_discovery(const RoutePlan& plan, const runtime::Playback& playback,
                        const runtime::Stop& stop) {
  std::uint64_t known = 0;
  std::int64_t changed_ns = runtime::monotonic_ns();
  const std::int64_t end_ns = changed_ns + 5 * runtime::kNsPerSecond;
  for (std::int64_t now_ns = changed_ns;
       !stop.requested() && now_ns < end_ns && now_ns - changed_ns < kSettled_ns;
       now_ns = runtime::monotonic_ns()) {
    std::uint64_t found = 0;
    for (const auto& [id, route] : plan.routes) found += playback.matched(route.writer);
    if (found > known) changed_ns = now_ns;
    known = found;
    runtime::sleep_until_ns(now_ns + kMatchPoll_ns);
  }
}

/// "" while nobody else writes a foreign topic that is played.  Its readers know no mark of a
/// replay: with another writer, a device would have two masters.
std::string second_writer(const RoutePlan& plan, const runtime::Playback& playback) {
  const std::map<std::string, std::string> others = playback.other_writers();
  for (const auto& [id, route] : plan.routes) {
    const auto other = others.find(route.topic);
    if (route.foreign && other != others.end()) {
      return fmt::format("{}, which {} writes", route.topic, other->second);
    }
  }
  return "";
}

void execute(Key key, Player& player, bool& quit) {
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

/// Log times [ns] to play.
struct PlaySpan {
  std::uint64_t first_ns, last_ns;
};

void print_progress(const Player& player, const PlaySpan& span) {
  if (isatty(STDERR_FILENO) != 1) return;
  const auto seconds = [&span](std::int64_t at_ns) {
    return static_cast<double>(at_ns - static_cast<std::int64_t>(span.first_ns)) / kNsPerS;
  };
  fmt::print(stderr, "\r\033[K{:.2f} of {:.2f} s  rate {}{}  {} messages",
             seconds(player.position_ns()), seconds(static_cast<std::int64_t>(span.last_ns)),
             player.rate().text(), player.paused() ? "  paused" : "", player.released());
}

/// "12.5", "0.000000001"
std::string seconds(std::uint64_t ns) {
  std::string text = fmt::format("{:.9f}", static_cast<double>(ns) / kNsPerS);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// @param totals  of a recording that has messages
PlaySpan span_of(const ReplayOptions& options, const recording::Statistics& totals) {
  const std::uint64_t length_ns = totals.end_time_ns - totals.start_time_ns;
  const auto start_ns = static_cast<std::uint64_t>(options.start_ns.value_or(0));
  const std::uint64_t end_ns =
      options.end_ns ? std::min(static_cast<std::uint64_t>(*options.end_ns), length_ns) : length_ns;
  if (start_ns > length_ns) {
    throw ConfigError(
        "--start", seconds(start_ns) + " s",
        fmt::format("at most {} s, the length of {}", seconds(length_ns), options.file));
  }
  if (start_ns > end_ns) throw ConfigError("--start", "later than --end", "--start before --end");
  return {totals.start_time_ns + start_ns, totals.start_time_ns + end_ns};
}

void check_recording(const std::string& file, const recording::McapReader& reader) {
  if (!reader.status().ok()) {
    throw ConfigError(file, reader.status().text, "a recording (MCAP, version 0)");
  }
  if (reader.statistics().message_count == 0) {
    throw ConfigError(file, "no messages", "a recording with messages");
  }
}

void check_wait_for(const ReplayOptions& options, const RoutePlan& plan) {
  for (const std::string& topic : options.wait_for) {
    if (std::ranges::none_of(plan.routes, [&](const auto& r) { return r.second.topic == topic; })) {
      throw ConfigError("--wait-for", topic, "a topic that is played");
    }
  }
}

/// Plays until the end, a command, a key or a signal, and while `obstacle` is "".
/// @returns the obstacle
std::string play(const ReplayOptions& options, const PlaySpan& span, const Played& played,
                 Player& player, Remote& remote, const runtime::Stop& stop,
                 const std::function<std::string()>& obstacle) {
  Keyboard keyboard(options.keyboard);
  player.begin(options.begin_paused);
  std::int64_t printed_ns = 0;
  std::int64_t status_ns = 0;
  std::string met;
  for (bool quit = false; !quit && !stop.requested() && met.empty();) {
    const std::optional<std::int64_t> idle_ns = player.step();
    if (!idle_ns) break;
    if (const auto key = keyboard.wait(std::max<std::int64_t>(*idle_ns, 0))) {
      execute(*key, player, quit);
    }
    if (const std::int64_t now_ns = runtime::monotonic_ns();
        now_ns - printed_ns > kPrintInterval_ns) {
      printed_ns = now_ns;
      print_progress(player, span);
    }
    execute(remote, player, played, quit);
    if (const std::int64_t now_ns = runtime::monotonic_ns();
        now_ns - status_ns >= kStatusInterval_ns) {
      status_ns = now_ns;
      publish_status(remote, player, played);
      met = obstacle();
    }
  }
  if (remote.asked()) publish_last_status(remote, player, played);
  return met;
}

void print_end(const Player& player, std::size_t channels, std::uint64_t unheard) {
  const recording::ReleaseErrors& errors = player.errors();
  fmt::print("{} messages of {} channels played\n", player.released(), channels);
  if (unheard > 0) fmt::print("no program received {} of them\n", unheard);
  const std::int64_t median_us = errors.percentile_us(0.50);
  if (median_us > kTooLate_us) {
    fmt::print(
        "this machine cannot play it at rate {}: half of the messages came later than {:g} s\n",
        player.rate().text(), 1e-6 * kTooLate_us);
  } else {
    fmt::print("the messages came late by {} us in the median, {} us in 99 %, {} us at most\n",
               median_us, errors.percentile_us(0.99), errors.max_us());
  }
  if (player.held_up() > 0) {
    fmt::print("late by more than 10 ms: {} times; then it plays at twice its rate to catch up\n",
               player.held_up());
  }
  std::fflush(stdout);
}

}  // namespace

int run_replay(const ReplayOptions& options, runtime::Stop& stop) {
  recording::FileSource file(options.file);
  const recording::McapReader reader(file);
  check_recording(options.file, reader);
  const recording::Statistics& totals = reader.statistics();
  const PlaySpan span = span_of(options, totals);
  check_names(options, reader);
  runtime::Playback playback(options.profiles, options.domain,
                             "stillhand-replay/" + std::to_string(getpid()));
  const RoutePlan plan = plan_routes(options, reader, playback);
  check_wait_for(options, plan);
  Remote remote(runtime::outsider("replay", options.domain, options.profiles, true),
                topics::kReplayCommand, topics::kReplayStatus);
  wait_for_readers(options, plan, playback, stop);
  wait_for_discovery(plan, playback, stop);
  if (const std::string two = second_writer(plan, playback); !two.empty()) {
    throw ConfigError("topic", two, "one that is written by nobody else, --remap or --block");
  }

  std::uint64_t refused = 0;
  std::uint64_t unheard = 0;
  MessageSource source(file, plan.wanted, plan.latched);
  Player player(source, span.first_ns, span.last_ns, options.rate, options.loop,
                [&](const recording::HeldMessage& message, std::span<const std::byte> bytes) {
                  const auto id = static_cast<ChannelId>(message.channel);
                  const std::size_t writer = plan.routes.at(id).writer;
                  if (playback.matched(writer) == 0) ++unheard;
                  if (!playback.write(writer, bytes)) ++refused;
                });
  const std::string obstacle =
      play(options, span, {options.file, totals.start_time_ns, totals.end_time_ns}, player, remote,
           stop, [&] { return second_writer(plan, playback); });
  if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r\033[K");
  playback.wait_for_acknowledgments(kAcknowledge_ns);
  print_end(player, plan.routes.size(), unheard);

  const std::vector<recording::Damage> damage = source.damage();
  const std::string loss =
      recording::loss_line(options.file, damage, std::nullopt, file.being_written());
  if (!loss.empty()) runtime::remark(loss);
  const std::string clock = recording::clock_line(options.file, reader);
  if (!clock.empty()) runtime::remark(clock);
  if (!obstacle.empty()) runtime::remark("stopped: a second writer of " + obstacle);
  if (refused > 0) runtime::remark(fmt::format("Fast DDS refused {} messages", refused));
  return recording::lost_bytes(damage) == 0 && refused == 0 && obstacle.empty() ? 0 : 1;
}

}  // namespace stillhand::replay
