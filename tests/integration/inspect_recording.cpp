// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/libraries/session/session_recording.hpp"
#include "services/core/contract/config_error.hpp"

// inspect_recording FILE LAST_TICKS [signals]: what the integration tests ask of a session's
// recording, as one JSON object; of the rig's truth its last LAST_TICKS samples, and with `signals`
// the same of what moves and is tracked.  The file may still be growing.
// Exit status 2 when the file is no recording.

namespace {

using nlohmann::json;

json trials_of(const stillhand::session::SessionRecording& session) {
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

template <typename Message>
std::vector<Message> newest(const std::vector<Message>& stream, std::size_t count) {
  return {stream.end() - static_cast<std::ptrdiff_t>(std::min(stream.size(), count)), stream.end()};
}

json signals_of(const stillhand::session::SessionRecording& session, std::size_t last_ticks) {
  json signals{{"truth", json::array()},    {"command", json::array()}, {"sensed", json::array()},
               {"tracking", json::array()}, {"force", json::array()},   {"pointer", json::array()},
               {"stick", json::array()},    {"motor", json::array()}};
  for (const auto& m : newest(session.rig_truths, last_ticks)) {
    signals["truth"].push_back({m.tick(), m.platform_position_m(), m.platform_acceleration_m_s2(),
                                m.feedthrough_force_n(), m.volitional_force_n()});
  }
  for (const auto& m : newest(session.platform_commands, last_ticks)) {
    signals["command"].push_back({m.tick(), m.position_m(), m.acceleration_m_s2()});
  }
  for (const auto& m : newest(session.sensed, last_ticks)) {
    signals["sensed"].push_back({m.tick(), m.accel_y_m_s2()});
    signals["stick"].push_back({m.tick(), m.theta_rad()});
  }
  for (const auto& m : newest(session.motor_commands, last_ticks)) {
    signals["motor"].push_back({m.tick(), m.force_n(), m.taken_off_rad()});
  }
  for (const auto& m : newest(session.tracking_samples, last_ticks)) {
    signals["tracking"].push_back({m.tick(), m.stamp_ns(), m.target_m(), m.cursor_m()});
  }
  for (const auto& m : newest(session.operator_forces, last_ticks)) {
    signals["force"].push_back({m.tick(), m.force_n()});
  }
  for (const auto& m : session.pointers) {
    if (m.inside_window()) signals["pointer"].push_back({m.tick(), m.position_m()});
  }
  return signals;
}

json notes_of(const stillhand::session::SessionRecording& session) {
  json notes = json::array();
  for (const auto& event : session.events) {
    if (event.kind() == stillhand_msgs::EVENT_NOTE) {
      notes.push_back({event.source().c_str(), event.text().c_str()});
    }
  }
  return notes;
}

// What was asked from outside, and that the interlock opened.
json commands_of(const stillhand::session::SessionRecording& session) {
  json commands = json::array();
  for (const auto& event : session.events) {
    if (event.kind() == stillhand_msgs::EVENT_COMMAND ||
        event.kind() == stillhand_msgs::EVENT_INTERLOCK_OPENED) {
      commands.push_back({event.source().c_str(), event.text().c_str()});
    }
  }
  return commands;
}

// Topic and name of each writer that its session did not name.
json second_writers_of(const stillhand::session::SessionRecording& session) {
  json writers = json::array();
  for (const auto& event : session.events) {
    if (event.kind() == stillhand_msgs::EVENT_SECOND_WRITER) {
      writers.push_back({event.topic().c_str(), event.peer().c_str()});
    }
  }
  return writers;
}

// Ticks at which the rig's force was zero after the interlock opened.
json force_zero_ticks_of(const stillhand::session::SessionRecording& session) {
  json ticks = json::array();
  for (const auto& event : session.events) {
    if (event.kind() == stillhand_msgs::EVENT_FORCE_ZERO) ticks.push_back(event.tick());
  }
  return ticks;
}

json clock_events_of(const stillhand::session::SessionRecording& session) {
  json events = json::array();
  for (const auto& event : session.events) {
    if (event.kind() == stillhand_msgs::EVENT_CLOCK_STEPPED ||
        event.kind() == stillhand_msgs::EVENT_CLOCK_DRIFTS) {
      events.push_back(event.text().c_str());
    }
  }
  return events;
}

json newest_motor_command(const stillhand::session::SessionRecording& session) {
  if (session.motor_commands.empty()) return {{"stamp_ns", -1}};
  const auto& newest = session.motor_commands.back();
  return {{"stamp_ns", newest.stamp_ns()},
          {"force_n", newest.force_n()},
          {"permitted", newest.permitted()}};
}

json rig_of(const stillhand::session::SessionRecording& session, std::size_t last_ticks) {
  json rig{{"tick", json::array()},
           {"stamp_ns", json::array()},
           {"motor_force_n", json::array()},
           {"motor_tick", json::array()},
           {"motor_permitted", json::array()},
           {"command_tick", json::array()},
           {"position_m", json::array()},
           {"velocity_m_s", json::array()},
           {"acceleration_m_s2", json::array()}};
  const auto& truths = session.rig_truths;
  for (std::size_t i = truths.size() - std::min(truths.size(), last_ticks); i < truths.size();
       ++i) {
    rig["tick"].push_back(truths[i].tick());
    rig["stamp_ns"].push_back(truths[i].stamp_ns());
    rig["motor_force_n"].push_back(truths[i].motor_force_n());
    rig["motor_tick"].push_back(truths[i].motor_tick());
    rig["motor_permitted"].push_back(truths[i].motor_permitted());
    rig["command_tick"].push_back(truths[i].command_tick());
    rig["position_m"].push_back(truths[i].platform_position_m());
    rig["velocity_m_s"].push_back(truths[i].platform_velocity_m_s());
    rig["acceleration_m_s2"].push_back(truths[i].platform_acceleration_m_s2());
  }
  return rig;
}

}  // namespace

int main(int argc, char** argv) {
  const bool signals = argc == 4 && std::string(argv[3]) == "signals";
  if (argc != 3 && !signals) {
    std::cerr << "usage: inspect_recording FILE LAST_TICKS [signals]\n";
    return 2;
  }
  try {
    const auto session = stillhand::session::read_session(argv[1]);
    const std::size_t last_ticks = std::strtoul(argv[2], nullptr, 10);
    json found{{"messages", session.messages},
               {"lost_ticks", session.lost_ticks},
               {"damage", session.damage},
               {"trials", trials_of(session)},
               {"rig", rig_of(session, last_ticks)},
               {"notes", notes_of(session)},
               {"clock_events", clock_events_of(session)},
               {"commands", commands_of(session)},
               {"force_zero_ticks", force_zero_ticks_of(session)},
               {"second_writers", second_writers_of(session)},
               {"newest_motor_command", newest_motor_command(session)}};
    if (signals) found["signals"] = signals_of(session, last_ticks);
    std::cout << found << '\n';
    return 0;
  } catch (const stillhand::ConfigError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
