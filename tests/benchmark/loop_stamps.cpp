// SPDX-License-Identifier: Apache-2.0
// loop_stamps FILE: latencies of the control loop in a session's recording, by the stamps of its
// messages, as one JSON object [us]: from the raw sample to the sensed sample, to the motor command
// and to the rig's step that used it, and the parts between them.  The ticks are those of the
// measured parts of the trials in which the motor may act.  Used by loop_latency.py.
#include <algorithm>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "apps/libraries/session/session_recording.hpp"
#include "services/bus/trial_codec.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "tests/benchmark/loop_figures.hpp"

namespace {

using namespace stillhand;  // NOLINT(google-build-using-namespace): a program of one file
using nlohmann::json;

struct Stamps {
  std::int64_t raw_ns = 0, sensed_ns = 0, command_ns = 0, used_ns = 0;
};

std::vector<Trial> trials_of(const session::SessionRecording& session) {
  std::set<std::int64_t> numbers;
  for (const auto& command : session.motor_commands) {
    if (!command.enabled()) continue;
    for (const auto& control : session.trial_controls) {
      if (runtime::from_idl(control).measures(command.tick())) numbers.insert(control.trial());
    }
    if (!numbers.empty()) break;
  }
  std::vector<Trial> trials;
  for (const auto& control : session.trial_controls) {
    if (numbers.erase(control.trial()) > 0) trials.push_back(runtime::from_idl(control));
  }
  return trials;
}

// What the readers of the loop measured of themselves, from stamp to receipt; bins of 1/8 octave.
json receipts_of(const session::SessionRecording& session) {
  json receipts = json::object();
  for (const auto& status : session.statuses) {
    for (const auto& topic : status.topics()) {
      if (topic.written() || topic.latency_max_us() <= 0.0) continue;
      receipts[std::string(status.service()) + " " + std::string(topic.topic())] = {
          {"p50", topic.latency_p50_us()},
          {"p99", topic.latency_p99_us()},
          {"worst", topic.latency_max_us()},
          {"cycle_misses", topic.cycle_misses()},
          {"lost_ticks", topic.lost_ticks()}};
    }
  }
  return receipts;
}

std::map<Tick, Stamps> stamps_of(const session::SessionRecording& session) {
  std::map<Tick, Stamps> by_tick;
  const std::vector<Trial> trials = trials_of(session);
  const auto judged = [&](Tick tick) {
    return std::ranges::any_of(trials, [&](const Trial& trial) { return trial.measures(tick); });
  };
  for (const auto& raw : session.raw_samples) {
    if (judged(raw.tick())) by_tick[raw.tick()].raw_ns = raw.stamp_ns();
  }
  const auto put = [&](Tick tick, std::int64_t Stamps::* which, std::int64_t stamp_ns) {
    const auto found = by_tick.find(tick);
    if (found != by_tick.end() && found->second.*which == 0) found->second.*which = stamp_ns;
  };
  for (const auto& m : session.sensed) put(m.tick(), &Stamps::sensed_ns, m.stamp_ns());
  for (const auto& m : session.motor_commands) put(m.tick(), &Stamps::command_ns, m.stamp_ns());
  for (const auto& m : session.rig_truths) put(m.motor_tick(), &Stamps::used_ns, m.stamp_ns());
  return by_tick;
}

json loop_of(const session::SessionRecording& session) {
  const std::map<Tick, Stamps> by_tick = stamps_of(session);
  std::vector<std::int64_t> sensed, command, used, to_sensed, to_command, to_use;
  for (const auto& [tick, s] : by_tick) {
    if (s.raw_ns == 0 || s.sensed_ns == 0 || s.command_ns == 0) continue;
    sensed.push_back(s.sensed_ns - s.raw_ns);
    command.push_back(s.command_ns - s.raw_ns);
    to_command.push_back(s.command_ns - s.sensed_ns);
    if (s.used_ns == 0) continue;
    used.push_back(s.used_ns - s.raw_ns);
    to_use.push_back(s.used_ns - s.command_ns);
  }
  std::size_t same_cycle = 0;
  for (const auto& truth : session.rig_truths) {
    if (truth.motor_tick() == truth.tick() && by_tick.count(truth.tick()) > 0) ++same_cycle;
  }
  const double ticks = static_cast<double>(std::max<std::size_t>(by_tick.size(), 1));
  return {{"ticks", by_tick.size()},
          {"unanswered", by_tick.size() - command.size()},
          {"same_cycle_share", static_cast<double>(same_cycle) / ticks},
          {"sensed", benchmark::figures(sensed)},
          {"command", benchmark::figures(command)},
          {"used", benchmark::figures(used)},
          {"sensed to command", benchmark::figures(to_command)},
          {"command to use", benchmark::figures(to_use)}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: loop_stamps FILE\n";
    return 2;
  }
  try {
    const auto session = session::read_session(argv[1]);
    json found = loop_of(session);
    found["receipts"] = receipts_of(session);
    std::cout << found << '\n';
    return 0;
  } catch (const ConfigError& error) {
    std::cerr << "loop_stamps: " << error.what() << '\n';
    return 2;
  }
}
