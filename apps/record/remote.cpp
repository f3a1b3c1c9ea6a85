// SPDX-License-Identifier: Apache-2.0
#include "apps/record/remote.hpp"

#include <fmt/format.h>

#include "apps/record/record_output.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::record {
namespace {

/// @returns why the command is refused, or ""
std::string execute_one(const stillhand_msgs::RecorderCommand& command, recording::Tape& tape,
                        bool windowed, runtime::Stop& stop) {
  switch (command.action()) {
    case stillhand_msgs::RECORDER_PAUSE:
      tape.set_paused(true);
      return {};
    case stillhand_msgs::RECORDER_RESUME:
      tape.set_paused(false);
      return {};
    case stillhand_msgs::RECORDER_TRIGGER:
      if (!windowed) return "no event window: every message is written";
      tape.trigger("a command" +
                   (command.text().size() == 0 ? "" : ": " + command.text().to_string()));
      return {};
    case stillhand_msgs::RECORDER_STOP:
      stop.request();
      return {};
    default:
      return "unknown action";
  }
}

}  // namespace

runtime::Bus::Options outsider(const std::string& verb, const RecordOptions& options) {
  runtime::Bus::Options bus = runtime::outsider(verb, options.domain, options.profiles, false);
  bus.security = options.security;
  return bus;
}

void execute(Remote& remote, recording::Tape& tape, bool windowed, runtime::Stop& stop) {
  while (const auto command = remote.next()) {
    const std::string wanted = command->recorder().to_string();
    if (!wanted.empty() && wanted != remote.name()) continue;
    remote.answer(*command, execute_one(*command, tape, windowed, stop));
  }
}

stillhand_msgs::RecorderStatus status_of(const Remote& remote, const recording::TapeStatus& tape,
                                         const std::map<std::string, recording::TopicTally>& topics,
                                         const std::string& missing) {
  stillhand_msgs::RecorderStatus status;
  status.recorder(remote.name());
  status.paused(tape.paused);
  for (const auto& [topic, tally] : topics) {
    status.received(status.received() + tally.received);
    status.lost(status.lost() + tally.lost);
  }
  status.written(tape.written);
  status.dropped(tape.dropped);
  status.held(tape.held);
  status.file_bytes(tape.bytes);
  status.free_bytes(tape.free_bytes);
  constexpr std::size_t kFileRoom = 254;  // of idl/recording.idl
  constexpr std::size_t kTroubleRoom = 199;
  status.file(tape.file.substr(0, kFileRoom));
  const std::string silent = missing.empty() ? "" : "silent: " + missing;
  status.trouble((tape.stopped.empty() ? silent : tape.stopped).substr(0, kTroubleRoom));
  return status;
}

int run_remote(const std::string& action, const RecordOptions& options, runtime::Stop& stop) {
  const std::map<std::string, stillhand_msgs::RecorderAction> actions{
      {"pause", stillhand_msgs::RECORDER_PAUSE},
      {"resume", stillhand_msgs::RECORDER_RESUME},
      {"trigger", stillhand_msgs::RECORDER_TRIGGER},
      {"stop", stillhand_msgs::RECORDER_STOP}};
  const auto known = actions.find(action);
  if (known == actions.end()) {
    throw ConfigError("--remote", action, "pause, resume, trigger or stop");
  }
  stillhand_msgs::RecorderCommand command;
  command.action(known->second);
  const auto status = runtime::ask<stillhand_msgs::RecorderCommand, stillhand_msgs::RecorderStatus>(
      outsider("remote", options), topics::kRecorderCommand, topics::kRecorderStatus, command,
      runtime::kAnswerLimit_ns, stop);
  if (!status) {
    warn(fmt::format("no recorder answers on domain {}", options.domain));
    return 1;
  }
  if (!status->accepted()) {
    warn(status->recorder().to_string() + ": " + status->answer().to_string());
    return 1;
  }
  fmt::print("{}: {}, {} received, {} lost, {} written\n", status->recorder().c_str(), action,
             status->received(), status->lost(), status->written());
  return 0;
}

}  // namespace stillhand::record
