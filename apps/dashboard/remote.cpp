// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/remote.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "services/system/process/clock.hpp"

namespace stillhand::dashboard {

namespace {

struct SessionPath {
  std::string_view path;
  stillhand_msgs::SessionAction action;
  bool has_text = false;  // a reason, or a note
};
constexpr std::array kSession{
    SessionPath{"/session/start", stillhand_msgs::SESSION_START},
    SessionPath{"/session/pause", stillhand_msgs::SESSION_PAUSE},
    SessionPath{"/session/stop", stillhand_msgs::SESSION_STOP},
    SessionPath{"/session/repeat", stillhand_msgs::SESSION_REPEAT, true},
    SessionPath{"/session/abort", stillhand_msgs::SESSION_ABORT, true},
    SessionPath{"/session/note", stillhand_msgs::SESSION_NOTE, true},
    SessionPath{"/emergency-stop", stillhand_msgs::SESSION_EMERGENCY_STOP}};

constexpr std::size_t kMostText = 100;  // string<100> of idl/session.idl

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

Outcome too_many() {
  return {Outcome::Kind::kTooMany,
          fmt::format("more than {} requests within a second", RequestRate::kMostPerSecond)};
}

// With the process number, which distinguishes hosts of one name and dashboards of one host.
std::string name_of_asker() {
  std::array<char, 41> host{};  // with the rest it fits string<64> of idl/session.idl
  gethostname(host.data(), host.size() - 1);
  return fmt::format("dashboard on {} ({})", host.data(), getpid());
}

runtime::Bus::Options bus_options(const LiveOptions& options, std::uint32_t rig) {
  runtime::Bus::Options bus;
  // A name for each process: two dashboards must not count as one service that is there twice.
  bus.service = fmt::format("{}-{}", topics::kDashboard, getpid());
  bus.rig = rig;
  bus.domain = options.domain;
  bus.profiles = options.profiles;
  bus.security = options.security;
  return bus;
}

}  // namespace

Remote::Remote(const LiveOptions& options, std::uint32_t rig)
    : domain_(fmt::format("domain {}", options.domain)),
      bus_(bus_options(options, rig)),
      session_(bus_.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand)),
      recorder_(bus_.publisher<stillhand_msgs::RecorderCommand>(topics::kRecorderCommand)),
      asker_(name_of_asker()),
      // Larger than every request of an earlier process of this name: a clock that is never set.
      request_(static_cast<std::uint64_t>(runtime::monotonic_ns())) {
  bus_.start();
}

void Remote::send(stillhand_msgs::SessionAction action, const std::string& text) {
  stillhand_msgs::SessionCommand command;
  command.request(++request_);
  command.action(action);
  command.asker(asker_);
  command.text(text);
  session_.write(command);
}

Outcome Remote::stop_at_once() {
  const std::int64_t now_ns = runtime::monotonic_ns();
  const bool asked = now_ns < stop_until_ns_;  // then step() writes it
  stop_until_ns_ = now_ns + 5 * runtime::kNsPerSecond;
  if (!asked) send(stillhand_msgs::SESSION_EMERGENCY_STOP, "");
  if (bus_.matched_peers(topics::kSessionCommand).contains("rig")) return {};
  return {Outcome::Kind::kRefused,
          domain_ + ": no rig is connected; the request is repeated for 5 s"};
}

Outcome Remote::ask(std::string_view path, const std::string& text) {
  const auto* session = std::ranges::find(kSession, path, &SessionPath::path);
  const auto* recorder = std::ranges::find(kRecorder, path, &RecorderPath::path);
  if (session != kSession.end()) {
    if (session->action == stillhand_msgs::SESSION_EMERGENCY_STOP) return stop_at_once();
    if (!bus_.matched_peers(topics::kSessionCommand).contains("experiment")) {
      return {Outcome::Kind::kRefused, domain_ + ": no session runs"};
    }
    if (session->has_text && (text.empty() || text.size() > kMostText)) {
      return {Outcome::Kind::kRefused,
              fmt::format("want a reason or note of 1 to {} characters", kMostText)};
    }
    if (!rate_.take(runtime::monotonic_ns())) return too_many();
    send(session->action, session->has_text ? text : "");
    return {};
  }
  if (recorder == kRecorder.end()) return {Outcome::Kind::kUnknown, ""};
  // By the name of its process (runtime::outsider).
  if (!std::ranges::any_of(bus_.matched_peers(topics::kRecorderCommand),
                           [](const std::string& peer) { return peer.starts_with("record-"); })) {
    return {Outcome::Kind::kRefused, domain_ + ": no `stillhand record` runs"};
  }
  if (!rate_.take(runtime::monotonic_ns())) return too_many();
  stillhand_msgs::RecorderCommand command;
  command.request(++request_);
  command.action(recorder->action);
  command.text(asker_);
  recorder_.write(command);
  send(stillhand_msgs::SESSION_NOTE, recorder->word);
  return {};
}

Outcome Remote::note(const std::string& what) {
  if (!rate_.take(runtime::monotonic_ns())) return too_many();
  send(stillhand_msgs::SESSION_NOTE, what);
  return {};
}

void Remote::step() {
  if (runtime::monotonic_ns() < stop_until_ns_) send(stillhand_msgs::SESSION_EMERGENCY_STOP, "");
}

}  // namespace stillhand::dashboard
