// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "contract/config_error.hpp"
#include "experiment/session_recording.hpp"

// inspect_recording FILE LAST_TICKS: what the integration tests ask of a session's recording, as
// one JSON object; of the rig's truth its last LAST_TICKS samples.  The file may still be growing.
// Exit status 2 when the file is no recording.

namespace {

using nlohmann::json;

json trials_of(const stillhand::experiment::SessionRecording& session) {
  json trials = json::array();
  for (const auto& control : session.trial_controls) {
    if (control.session() != stillhand_msgs::SESSION_RUNNING || control.trial() < 0) continue;
    trials.push_back({{"number", control.trial()},
                      {"start_tick", control.start_tick()},
                      {"duration_ticks", control.duration_ticks()},
                      {"ramp_ticks", control.ramp_ticks()}});
  }
  return trials;
}

json rig_of(const stillhand::experiment::SessionRecording& session, std::size_t last_ticks) {
  json rig{{"tick", json::array()},
           {"stamp_ns", json::array()},
           {"motor_force_n", json::array()},
           {"motor_tick", json::array()},
           {"motor_permitted", json::array()}};
  const auto& truths = session.rig_truths;
  for (std::size_t i = truths.size() - std::min(truths.size(), last_ticks); i < truths.size();
       ++i) {
    rig["tick"].push_back(truths[i].tick());
    rig["stamp_ns"].push_back(truths[i].stamp_ns());
    rig["motor_force_n"].push_back(truths[i].motor_force_n());
    rig["motor_tick"].push_back(truths[i].motor_tick());
    rig["motor_permitted"].push_back(truths[i].motor_permitted());
  }
  return rig;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: inspect_recording FILE LAST_TICKS\n";
    return 2;
  }
  try {
    const auto session = stillhand::experiment::read_session(argv[1]);
    const json found{{"messages", session.messages},
                     {"lost_ticks", session.lost_ticks},
                     {"damage", session.damage},
                     {"trials", trials_of(session)},
                     {"rig", rig_of(session, std::strtoul(argv[2], nullptr, 10))},
                     {"newest_motor_command_ns", session.motor_commands.empty()
                                                     ? std::int64_t{-1}
                                                     : session.motor_commands.back().stamp_ns()}};
    std::cout << found << '\n';
    return 0;
  } catch (const stillhand::ConfigError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
