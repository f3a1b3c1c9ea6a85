// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/replay_command.hpp"

#include <cmath>
#include <memory>

#include "apps/replay/replay.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::replay {
namespace {

constexpr double kMostSeconds = 1e7;

struct Arguments {
  ReplayOptions options;
  bool ordinary = false;
  std::string rate = "1", remote;
  std::vector<std::string> remap;
  double start_s = -1, end_s = -1, wait_s = 20;
};

std::int64_t ns_of(double seconds) {
  return std::llround(seconds * static_cast<double>(runtime::kNsPerSecond));
}

int run(Arguments arguments) {
  ReplayOptions& options = arguments.options;
  const auto rate = recording::PlayRate::parse(arguments.rate);
  if (!rate) throw ConfigError("--rate", arguments.rate, "0.1 to 100, at most three decimals");
  options.rate = *rate;
  for (const std::string& pair : arguments.remap) {
    const std::size_t sign = pair.find('=');
    if (sign == 0 || sign == std::string::npos || sign + 1 == pair.size()) {
      throw ConfigError("--remap", pair, "RECORDED=WRITTEN, two names of topics");
    }
    options.remap[pair.substr(0, sign)] = pair.substr(sign + 1);
  }
  if (arguments.start_s >= 0) options.start_ns = ns_of(arguments.start_s);
  if (arguments.end_s >= 0) options.end_ns = ns_of(arguments.end_s);
  options.wait_limit_ns = ns_of(arguments.wait_s);
  options.keyboard = true;
  runtime::Stop stop;
  if (!arguments.remote.empty()) return run_remote(arguments.remote, options, stop);
  if (options.file.empty()) throw ConfigError("REC", "none", "the MCAP recording to play");
  // Before the participant exists, since Fast DDS's threads inherit the priority.  If the system
  // refuses it, the verb runs without.
  if (!arguments.ordinary) runtime::become_real_time();
  return run_replay(options, stop);
}

}  // namespace

void add_replay_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  ReplayOptions& options = arguments->options;
  options.profiles = runtime::shipped("qos/profiles.xml");
  command_line::Command verb = cli.add_subcommand(
      "replay",
      "Plays a recording onto the bus, byte for byte, with the recorded QoS. Every message\n"
      "carries the replay's mark: processes of a session drop it, and no rig on the domain\n"
      "produces a motor force while a replay runs. Processes started with --answer-replay\n"
      "accept it.\n"
      "Keys: space pause; left and right 5 s back and forward; s next message; + and - rate; a\n"
      "loop start, b loop end, c loop off; q quit.\n"
      "Example: stillhand replay run/session.mcap --domain 7 --topics stillhand/sensed --rate 0.5");
  verb.add_option("REC", options.file, "MCAP recording");
  verb.add_option("--rate", arguments->rate, "speed relative to the recording, 0.1 to 100");
  verb.add_option("--topics", options.topics.allow,
                  "pattern of topics to play (* any run of characters, ? one); may be repeated")
      .repeatable();
  verb.add_option("--block", options.topics.block, "pattern of topics not to play; may be repeated")
      .repeatable();
  verb.add_option("--remap", arguments->remap,
                  "RECORDED=WRITTEN: write a topic under another name; may be repeated")
      .repeatable();
  verb.add_option("--start", arguments->start_s,
                  "begin at this time [s] after the recording's start")
      .default_str("")
      .check(settings::number_between(0.0, kMostSeconds));
  verb.add_option("--end", arguments->end_s, "end at this time [s] after the recording's start")
      .default_str("")
      .check(settings::number_between(0.0, kMostSeconds));
  verb.add_flag("--loop", options.loop, "play again from the start when the end is reached");
  verb.add_flag("--paused", options.begin_paused, "begin paused");
  verb.add_option("--wait-for", options.wait_for,
                  "topic that must have a reader before the replay begins; may be repeated")
      .repeatable();
  verb.add_option("--wait-seconds", arguments->wait_s, "longest wait of --wait-for [s]")
      .check(settings::number_between(0.0, kMostSeconds));
  verb.add_option("--remote", arguments->remote,
                  "do not play; send this to the replay of the domain; or \"seek S\", \"rate R\", "
                  "\"loop S S\"")
      .type_name("{play,pause,step,stop,loop-off}");
  verb.add_flag("--no-real-time", arguments->ordinary, "do not ask for real-time priority");
  verb.add_option("--domain", options.domain, "DDS domain, 0 to 232");
  verb.add_option("--profiles", options.profiles, "QoS profiles");
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::replay
