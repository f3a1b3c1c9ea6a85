// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record.hpp"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include "apps/record/field_trigger.hpp"
#include "idl/cdr.hpp"
#include "idl/recording.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/bus_recording.hpp"
#include "services/recording/session_texts.hpp"
#include "services/runtime/bus/security.hpp"
#include "services/runtime/bus/tap.hpp"
#include "services/runtime/process/clock.hpp"
#include "services/runtime/remote_control.hpp"

namespace stillhand::record {
namespace {

constexpr std::int64_t kPoll_ns = 20'000'000;
constexpr std::int64_t kTellInterval_ns = runtime::kNsPerSecond;
constexpr std::int64_t kStatusInterval_ns = runtime::kNsPerSecond / 10;
constexpr std::int64_t kAnswer_ns = 5 * runtime::kNsPerSecond;

bool is_missed_deadline(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  stillhand_msgs::Event event;
  return writer.topic == topics::kEvent.name && writer.type == topics::kEvent.type &&
         from_cdr(sample.bytes, event) && event.kind() == stillhand_msgs::EVENT_DEADLINE_MISSED;
}

/// Red on a terminal.
void warn(const std::string& line) {
  const bool red = isatty(STDERR_FILENO) == 1;
  std::fprintf(stderr, "%s%s%s\n", red ? "\033[31m" : "", line.c_str(), red ? "\033[0m" : "");
}

/// Says which required topics are silent, whenever that changes or a trial is announced.
class RequiredTopics {
 public:
  explicit RequiredTopics(const std::vector<std::string>& required) : required_(required) {}

  void step(const std::set<std::string>& heard, std::int64_t trial) {
    missing_.clear();
    for (const std::string& topic : required_) {
      if (heard.count(topic) == 0) missing_ += (missing_.empty() ? "" : ", ") + topic;
    }
    const bool announced = trial >= 0 && trial != trial_;
    if (!missing_.empty() && (announced || missing_ != told_)) {
      warn(announced ? "trial " + std::to_string(trial) + " begins without " + missing_
                     : "required and not there yet: " + missing_);
    }
    if (missing_.empty() && !told_.empty()) std::fprintf(stderr, "every required topic is there\n");
    told_ = missing_;
    trial_ = trial;
  }
  [[nodiscard]] const std::string& missing() const noexcept { return missing_; }

 private:
  const std::vector<std::string>& required_;
  std::string missing_;
  std::string told_;
  std::int64_t trial_ = -1;
};

void tell_progress(const recording::TapeStatus& tape, std::uint64_t lost, std::int64_t elapsed_ns) {
  if (isatty(STDERR_FILENO) != 1) return;
  std::fprintf(stderr, "\r\033[K%" PRId64 " s  %" PRIu64 " messages  %.1f MiB  %" PRIu64 " lost%s",
               elapsed_ns / runtime::kNsPerSecond, tape.written,
               static_cast<double>(tape.bytes) / 1048576.0, lost, tape.paused ? "  paused" : "");
}

using Remote =
    runtime::RemoteControl<stillhand_msgs::RecorderCommand, stillhand_msgs::RecorderStatus>;

/// Obeys what has come.
void obey(Remote& remote, recording::Tape& tape, bool windowed, runtime::Stop& stop) {
  while (const auto command = remote.next()) {
    const std::string wanted = command->recorder().to_string();
    if (!wanted.empty() && wanted != remote.name()) continue;
    std::string refusal;
    switch (command->action()) {
      case stillhand_msgs::RECORDER_PAUSE:
        tape.set_paused(true);
        break;
      case stillhand_msgs::RECORDER_RESUME:
        tape.set_paused(false);
        break;
      case stillhand_msgs::RECORDER_TRIGGER:
        if (windowed) {
          tape.trigger("a command" +
                       (command->text().size() == 0 ? "" : ": " + command->text().to_string()));
        } else {
          refusal = "no event window: everything is being written";
        }
        break;
      case stillhand_msgs::RECORDER_STOP:
        stop.request();
        break;
      default:
        refusal = "no such action";
    }
    remote.answer(*command, refusal);
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

struct Totals {
  std::uint64_t received = 0, lost = 0, written = 0;
};

Totals tell_topics(const std::map<std::string, recording::TopicTally>& topics) {
  Totals totals;
  std::printf("%-32s %12s %10s %10s %12s\n", "topic", "received", "lost", "(not sent)", "written");
  for (const auto& [topic, tally] : topics) {
    std::printf("%-32s %12" PRIu64 " %10" PRIu64 " %10" PRIu64 " %12" PRIu64 "%s\n", topic.c_str(),
                tally.received, tally.lost, tally.not_sent, tally.written,
                tally.type_known ? "" : "  type not known: not recorded");
    totals.received += tally.received;
    totals.lost += tally.lost;
    totals.written += tally.written;
  }
  return totals;
}

/// What became of everything, for people.  @returns whether nothing is missing
bool tell_end(const recording::BusRecording& recorded, const runtime::Tap& tap,
              const recording::Status& closed, std::uint32_t domain) {
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  const Totals totals = tell_topics(recorded.tally().topics(tap.writers()));
  const recording::TapeStatus end = recorded.tape().status();
  std::printf("%" PRIu64 " messages in %u file%s, the last %s\n", end.written, end.parts,
              end.parts == 1 ? "" : "s", end.file.c_str());
  if (end.passed_over > 0) {
    std::printf("%" PRIu64 " messages passed over: paused, or outside the event window\n",
                end.passed_over);
  }
  const std::vector<std::string> trouble = tap.trouble();
  for (const std::string& line : trouble) warn(line);
  if (totals.lost > 0) warn(std::to_string(totals.lost) + " messages lost on their way here");
  if (end.dropped > 0) warn(std::to_string(end.dropped) + " messages received and not written");
  if (tap.unattributed() > 0) {
    warn(std::to_string(tap.unattributed()) + " messages of writers that were never announced");
  }
  if (totals.received == 0) warn("nothing was heard on domain " + std::to_string(domain));
  if (!closed.ok()) warn(closed.text);
  return closed.ok() && trouble.empty() && totals.lost == 0 && end.dropped == 0 &&
         tap.unattributed() == 0 && totals.received > 0;
}

runtime::Bus::Options outsider(const std::string& verb, const RecordOptions& options) {
  runtime::Bus::Options bus = runtime::outsider(verb, options.domain, options.profiles, false);
  bus.security = options.security;
  return bus;
}

}  // namespace

int run_record(const RecordOptions& options, runtime::Stop& stop) {
  std::vector<FieldTrigger> triggers;
  for (const std::string& text : options.triggers) triggers.emplace_back(text);
  // Made once nothing can be refused any more, so that a refusal leaves no file; gone after the
  // tap.
  std::optional<recording::BusRecording> recorded;

  runtime::Tap::Options tap_options;
  tap_options.name = "stillhand-record/" + std::to_string(getpid());
  tap_options.domain = options.domain;
  tap_options.profiles = options.profiles;
  tap_options.wanted = [&options](const std::string& topic) { return options.topics.wants(topic); };
  tap_options.on_sample = [&](const runtime::FoundWriter& writer,
                              const runtime::TappedSample& sample) {
    recorded->take(writer, sample);
    for (FieldTrigger& trigger : triggers) {
      if (trigger.step(writer, sample)) recorded->tape().trigger(trigger.text());
    }
    if (options.trigger_on_deadline && is_missed_deadline(writer, sample)) {
      recorded->tape().trigger("a missed deadline");
    }
  };
  tap_options.security = options.security;
  runtime::Tap tap(tap_options);
  if (!options.security.empty()) {
    const std::string warning =
        runtime::expiry_warning(runtime::Identity::of(options.security, "record"));
    if (!warning.empty()) warn(warning);
  }
  Remote remote(outsider("record", options), topics::kRecorderCommand, topics::kRecorderStatus);
  recording::TapeOptions tape_options = options.tape;
  tape_options.session = recording::session_texts(options.domain, "stillhand record");
  recorded.emplace(std::move(tape_options));
  tap.start();

  recording::Tape& tape = recorded->tape();
  const recording::Tally& tally = recorded->tally();
  const recording::TrialLog& trials = recorded->trials();
  RequiredTopics required(options.required);
  const std::int64_t began_ns = runtime::monotonic_ns();
  std::int64_t told_ns = 0;
  std::int64_t status_ns = 0;
  for (std::int64_t now_ns = began_ns; !stop.requested() && !tape.stopped();
       now_ns = runtime::monotonic_ns()) {
    if (options.duration_ns && now_ns - began_ns >= *options.duration_ns) break;
    obey(remote, tape, options.tape.window_ns > 0, stop);
    if (now_ns - status_ns >= kStatusInterval_ns) {
      status_ns = now_ns;
      remote.tell(status_of(remote, tape.status(), tally.topics({}), required.missing()));
    }
    if (now_ns - told_ns >= kTellInterval_ns) {
      told_ns = now_ns;
      std::uint64_t lost = 0;
      for (const auto& [topic, counts] : tally.topics({})) lost += counts.lost;
      tell_progress(tape.status(), lost, now_ns - began_ns);
      required.step(tally.heard(), trials.newest());
    }
    runtime::sleep_until_ns(now_ns + kPoll_ns);
  }
  tap.stop();
  const recording::Status closed = tape.close();
  required.step(tally.heard(), trials.newest());
  if (remote.asked()) {
    remote.tell_last(status_of(remote, tape.status(), tally.topics({}), required.missing()));
  }
  const bool whole = tell_end(*recorded, tap, closed, options.domain);
  return whole && required.missing().empty() ? 0 : 1;
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
      kAnswer_ns, stop);
  if (!status) {
    warn("no recorder answers on domain " + std::to_string(options.domain));
    return 1;
  }
  if (!status->accepted()) {
    warn(status->recorder().to_string() + ": " + status->answer().to_string());
    return 1;
  }
  std::printf("%s: %s, %" PRIu64 " received, %" PRIu64 " lost, %" PRIu64 " written\n",
              status->recorder().c_str(), action.c_str(), status->received(), status->lost(),
              status->written());
  return 0;
}

}  // namespace stillhand::record
