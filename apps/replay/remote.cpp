// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/remote.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "apps/replay/replay.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::replay {
namespace {

using stillhand_msgs::ReplayAction;

bool inside(double at_s, const Played& played) {
  const double length_s = static_cast<double>(played.end_ns - played.start_ns) / kNsPerS;
  return std::isfinite(at_s) && at_s >= 0.0 && at_s <= length_s;
}

std::int64_t log_time(double at_s, const Played& played) {
  return static_cast<std::int64_t>(played.start_ns) + std::llround(at_s * kNsPerS);
}

/// @returns why the command is refused, or ""
std::string execute_one(const stillhand_msgs::ReplayCommand& command, Player& player,
                        const Played& played, bool& quit) {
  switch (command.action()) {
    case stillhand_msgs::REPLAY_PLAY:
      player.set_paused(false);
      return {};
    case stillhand_msgs::REPLAY_PAUSE:
      player.set_paused(true);
      return {};
    case stillhand_msgs::REPLAY_STEP:
      player.set_paused(true);
      player.step_once();
      return {};
    case stillhand_msgs::REPLAY_STOP:
      quit = true;
      return {};
    case stillhand_msgs::REPLAY_LOOP_OFF:
      player.loop_off();
      return {};
    case stillhand_msgs::REPLAY_SEEK:
      if (!inside(command.from_s(), played)) return "the instant is outside the recording";
      player.seek(log_time(command.from_s(), played));
      return {};
    case stillhand_msgs::REPLAY_LOOP:
      if (!inside(command.from_s(), played) || !inside(command.to_s(), played) ||
          command.from_s() >= command.to_s()) {
        return "a loop needs two instants inside the recording, the earlier one first";
      }
      player.loop_between(log_time(command.from_s(), played), log_time(command.to_s(), played));
      return {};
    case stillhand_msgs::REPLAY_RATE: {
      const double per_mille = command.rate() * 1000.0;
      if (!(per_mille >= static_cast<double>(recording::PlayRate::kSlowest)) ||
          per_mille > static_cast<double>(recording::PlayRate::kFastest)) {
        return "the rate is outside 0.1 to 100";
      }
      player.set_rate({std::llround(per_mille)});
      return {};
    }
  }
  return "unknown action";
}

}  // namespace

void execute(Remote& remote, Player& player, const Played& played, bool& quit) {
  while (const auto command = remote.next()) {
    remote.answer(*command, execute_one(*command, player, played, quit));
    // At once, for the program that asked.
    publish_status(remote, player, played);
  }
}

namespace {

stillhand_msgs::ReplayStatus status_of(const Player& player, const Played& played) {
  stillhand_msgs::ReplayStatus status;
  status.paused(player.paused());
  status.position_s(
      static_cast<double>(player.position_ns() - static_cast<std::int64_t>(played.start_ns)) /
      kNsPerS);
  status.length_s(static_cast<double>(played.end_ns - played.start_ns) / kNsPerS);
  status.rate(static_cast<double>(player.rate().per_mille) / 1000.0);
  status.looping(player.looping());
  status.released(player.released());
  constexpr std::size_t kFileRoom = 254;  // string<255> in idl/recording.idl
  status.file(played.file.substr(0, kFileRoom));
  return status;
}

}  // namespace

void publish_status(Remote& remote, const Player& player, const Played& played) {
  remote.publish(status_of(player, played));
}

void publish_last_status(Remote& remote, const Player& player, const Played& played) {
  remote.publish_last(status_of(player, played));
}

stillhand_msgs::ReplayCommand parse_command(const std::string& text) {
  struct Form {
    ReplayAction action;
    std::size_t numbers;
  };
  const std::map<std::string, Form> forms{{"play", {stillhand_msgs::REPLAY_PLAY, 0}},
                                          {"pause", {stillhand_msgs::REPLAY_PAUSE, 0}},
                                          {"step", {stillhand_msgs::REPLAY_STEP, 0}},
                                          {"stop", {stillhand_msgs::REPLAY_STOP, 0}},
                                          {"loop-off", {stillhand_msgs::REPLAY_LOOP_OFF, 0}},
                                          {"seek", {stillhand_msgs::REPLAY_SEEK, 1}},
                                          {"rate", {stillhand_msgs::REPLAY_RATE, 1}},
                                          {"loop", {stillhand_msgs::REPLAY_LOOP, 2}}};
  std::istringstream words(text);
  std::string word;
  words >> word;
  const auto form = forms.find(word);
  std::vector<double> numbers;
  bool sound = form != forms.end();
  for (std::string each; words >> each;) {
    std::istringstream text_of_number(each);
    double number = 0;
    sound = sound && text_of_number >> number && text_of_number.eof();
    numbers.push_back(number);
  }
  if (!sound || numbers.size() != form->second.numbers) {
    throw ConfigError("--remote", text,
                      "play, pause, step, stop, loop-off, \"seek S\", \"rate R\" or \"loop S S\"");
  }
  stillhand_msgs::ReplayCommand command;
  command.action(form->second.action);
  if (form->second.action == stillhand_msgs::REPLAY_RATE) {
    command.rate(numbers[0]);
  } else if (!numbers.empty()) {
    command.from_s(numbers[0]);
    command.to_s(numbers.back());
  }
  return command;
}

int run_remote(const std::string& text, const ReplayOptions& options, runtime::Stop& stop) {
  const auto status = runtime::ask<stillhand_msgs::ReplayCommand, stillhand_msgs::ReplayStatus>(
      runtime::outsider("remote", options.domain, options.profiles, true), topics::kReplayCommand,
      topics::kReplayStatus, parse_command(text), runtime::kAnswerLimit_ns, stop);
  if (!status) {
    runtime::remark(fmt::format("no replay answers on domain {}", options.domain));
    return 1;
  }
  if (!status->accepted()) {
    runtime::remark(text + ": " + status->answer().c_str());
    return 1;
  }
  fmt::print("{:.3f} of {:.3f} s, rate {:g}{}{}, {} messages\n", status->position_s(),
             status->length_s(), status->rate(), status->paused() ? ", paused" : "",
             status->looping() ? ", looping" : "", status->released());
  return 0;
}

}  // namespace stillhand::replay
