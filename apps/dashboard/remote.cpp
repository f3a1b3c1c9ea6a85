// SPDX-License-Identifier: Apache-2.0
#include "dashboard/remote.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>

#include "runtime/clock.hpp"

namespace stillhand::dashboard {

namespace {

struct SessionPath {
  std::string_view path;
  stillhand_msgs::SessionAction action;
};
constexpr std::array kSession{
    SessionPath{"/session/start", stillhand_msgs::SESSION_START},
    SessionPath{"/session/pause", stillhand_msgs::SESSION_PAUSE},
    SessionPath{"/session/stop", stillhand_msgs::SESSION_STOP},
    SessionPath{"/emergency-stop", stillhand_msgs::SESSION_EMERGENCY_STOP}};

struct RecorderPath {
  std::string_view path;
  stillhand_msgs::RecorderAction action;
  const char* word;
};
constexpr std::array kRecorder{
    RecorderPath{"/recorder/pause", stillhand_msgs::RECORDER_PAUSE, "recorders: pause"},
    RecorderPath{"/recorder/resume", stillhand_msgs::RECORDER_RESUME, "recorders: resume"},
    RecorderPath{"/recorder/trigger", stillhand_msgs::RECORDER_TRIGGER, "recorders: trigger"},
    RecorderPath{"/recorder/stop", stillhand_msgs::RECORDER_STOP, "recorders: stop"}};

std::string name_of_asker() {
  std::array<char, 48> host{};  // with the rest it fits string<64> of idl/session.idl
  gethostname(host.data(), host.size() - 1);
  return "dashboard on " + std::string(host.data());
}

runtime::Bus::Options bus_options(const LiveOptions& options, std::uint32_t rig) {
  runtime::Bus::Options bus;
  // A name of its own: two dashboards are not one service that is there twice.
  bus.service = std::string(topics::kDashboard) + "-" + std::to_string(getpid());
  bus.rig = rig;
  bus.domain = options.domain;
  bus.profiles = options.profiles;
  bus.security = options.security;
  return bus;
}

}  // namespace

Remote::Remote(const LiveOptions& options, std::uint32_t rig)
    : domain_(options.domain),
      bus_(bus_options(options, rig)),
      session_(bus_.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand)),
      recorder_(bus_.publisher<stillhand_msgs::RecorderCommand>(topics::kRecorderCommand)),
      asker_(name_of_asker()) {
  bus_.start();
}

bool Remote::heard(const topics::Topic& topic) const {
  return std::ranges::any_of(bus_.report(), [&](const runtime::EndpointReport& report) {
    return report.topic == &topic && report.matched > 0;
  });
}

void Remote::send(stillhand_msgs::SessionAction action, const std::string& text) {
  stillhand_msgs::SessionCommand command;
  // Larger than any before, also than those of an earlier dashboard on this host.
  command.request(static_cast<std::uint64_t>(runtime::system_ns()));
  command.action(action);
  command.asker(asker_);
  command.text(text);
  session_.write(command);
}

std::optional<std::string> Remote::ask(std::string_view path) {
  const std::string nobody = "nobody listens on domain " + std::to_string(domain_);
  if (const auto* found = std::ranges::find(kSession, path, &SessionPath::path);
      found != kSession.end()) {
    const bool emergency = found->action == stillhand_msgs::SESSION_EMERGENCY_STOP;
    if (emergency) stop_until_ns_ = runtime::system_ns() + 5 * runtime::kNsPerSecond;
    if (!heard(topics::kSessionCommand)) {
      return nobody + (emergency ? ": asked again for 5 s" : ": no session runs");
    }
    send(found->action, "");
    return "";
  }
  const auto* found = std::ranges::find(kRecorder, path, &RecorderPath::path);
  if (found == kRecorder.end()) return std::nullopt;
  if (!heard(topics::kRecorderCommand)) return nobody + ": no `stillhand record` runs";
  stillhand_msgs::RecorderCommand command;
  command.request(static_cast<std::uint64_t>(runtime::system_ns()));
  command.action(found->action);
  command.text(asker_);
  recorder_.write(command);
  note(found->word);
  return "";
}

void Remote::note(const std::string& what) { send(stillhand_msgs::SESSION_NOTE, what); }

void Remote::step(std::int64_t now_ns) {
  if (now_ns < stop_until_ns_) send(stillhand_msgs::SESSION_EMERGENCY_STOP, "");
}

}  // namespace stillhand::dashboard
