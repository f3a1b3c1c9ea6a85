// SPDX-License-Identifier: Apache-2.0
#include "apps/record/record.hpp"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "apps/record/field_trigger.hpp"
#include "apps/record/record_output.hpp"
#include "apps/record/remote.hpp"
#include "idl/cdr.hpp"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/bus/identity.hpp"
#include "services/bus/recording/bus_recording.hpp"
#include "services/bus/recording/session_texts.hpp"
#include "services/bus/tap.hpp"
#include "services/core/recording/messages/omgidl.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::record {
namespace {

constexpr std::int64_t kPoll_ns = 20'000'000;
constexpr std::int64_t kPrintInterval_ns = runtime::kNsPerSecond;
constexpr std::int64_t kStatusInterval_ns = runtime::kNsPerSecond / 10;

bool is_missed_deadline(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  stillhand_msgs::Event event;
  return writer.topic == topics::kEvent.name && writer.type == topics::kEvent.type &&
         from_cdr(sample.bytes, event) && event.kind() == stillhand_msgs::EVENT_DEADLINE_MISSED;
}

std::vector<FieldTrigger> triggers_of(const RecordOptions& options) {
  std::vector<FieldTrigger> triggers;
  for (const std::string& text : options.triggers) triggers.emplace_back(text);
  return triggers;
}

/// The types of IDL files that the command line names.
class DefinedTypes {
 public:
  /// @throws ConfigError for a file that cannot be read or is no IDL
  explicit DefinedTypes(const std::vector<std::filesystem::path>& files) {
    for (const auto& file : files) {
      std::string text = recording::read_file(file.string());
      recording::IdlSchema types = recording::parse_idl(text, file.string());
      files_.emplace_back(std::move(text), std::move(types));
    }
  }
  /// Text of the file that defines a type, or "".
  [[nodiscard]] std::string text_of(const std::string& type) const {
    const auto found = std::ranges::find_if(
        files_, [&type](const auto& file) { return file.second.find(type) != nullptr; });
    return found == files_.end() ? "" : found->first;
  }

 private:
  std::vector<std::pair<std::string, recording::IdlSchema>> files_;
};

recording::TapeOptions tape_options(const RecordOptions& options) {
  recording::TapeOptions tape = options.tape;
  tape.session = recording::session_texts(options.domain, "stillhand record");
  return tape;
}

void warn_of_expiry(const RecordOptions& options) {
  if (options.security.empty()) return;
  const std::string warning =
      runtime::expiry_warning(runtime::Identity::of(options.security, "record"));
  if (!warning.empty()) warn(warning);
}

/// One run of the verb.
class Run {
 public:
  Run(const RecordOptions& options, runtime::Stop& stop)
      : options_(options),
        stop_(stop),
        triggers_(triggers_of(options)),
        defined_(options.idl),
        required_(options.required),
        tap_(tap_options()),
        remote_(outsider("record", options), topics::kRecorderCommand, topics::kRecorderStatus) {
    warn_of_expiry(options);
    // The file is created after everything that can refuse to start, so a refusal leaves no file.
    recorded_.emplace(tape_options(options));
  }

  /// @returns the exit status
  int operator()() {
    tap_.start();
    loop();
    tap_.stop();
    const recording::Status closed = recorded_->tape().close();
    required_.step(recorded_->tally().heard(), recorded_->trials().newest());
    if (remote_.asked()) remote_.publish_last(status());
    const bool whole = print_end(*recorded_, tap_, closed, options_.domain);
    return whole && required_.missing().empty() ? 0 : 1;
  }

 private:
  runtime::Tap::Options tap_options() {
    runtime::Tap::Options tap;
    tap.any_type = true;
    tap.idl_of = [this](const std::string& type) { return defined_.text_of(type); };
    tap.name = "stillhand-record/" + std::to_string(getpid());
    tap.domain = options_.domain;
    tap.profiles = options_.profiles;
    tap.security = options_.security;
    tap.wanted = [this](const std::string& topic) { return wants(topic); };
    tap.on_sample = [this](const runtime::FoundWriter& writer,
                           const runtime::TappedSample& sample) { take(writer, sample); };
    tap.on_instance_end = [this](std::size_t writer, std::int64_t sequence) {
      recorded_->end_instance(writer, sequence);
    };
    return tap;
  }

  // In a thread of discovery.
  bool wants(const std::string& topic) {
    const bool wanted = options_.topics.wants(topic);
    const std::lock_guard lock(seen_);
    if (wanted) {
      some_wanted_ = true;
    } else if (topic != topics::kRecorderStatus.name) {  // every recorder's, this one's too
      unwanted_.insert(topic);
    }
    return wanted;
  }

  // A pattern with a typing error would record nothing until somebody looks. Said again when more
  // topics are found: discovery of a busy bus takes its time, and a part of the list misleads.
  void warn_of_patterns() {
    std::set<std::string> there;
    {
      const std::lock_guard lock(seen_);
      if (some_wanted_ || unwanted_.size() == unwanted_said_) return;
      unwanted_said_ = unwanted_.size();
      there = unwanted_;
    }
    warn(
        fmt::format("no topic on domain {} is selected by --topics and --block; it has {}; waiting",
                    options_.domain, fmt::join(there, ", ")));
  }

  // In a receiving thread.
  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
    recorded_->take(writer, sample);
    for (FieldTrigger& trigger : triggers_) {
      if (trigger.step(writer, sample)) recorded_->tape().trigger(trigger.text());
    }
    if (options_.trigger_on_deadline && is_missed_deadline(writer, sample)) {
      recorded_->tape().trigger("a missed deadline");
    }
  }

  void loop() {
    recording::Tape& tape = recorded_->tape();
    const std::int64_t began_ns = runtime::monotonic_ns();
    std::int64_t printed_ns = 0;
    std::int64_t status_ns = 0;
    for (std::int64_t now_ns = began_ns; !stop_.requested() && !tape.stopped();
         now_ns = runtime::monotonic_ns()) {
      if (options_.duration_ns && now_ns - began_ns >= *options_.duration_ns) break;
      execute(remote_, tape, options_.tape.window_ns > 0, stop_);
      if (now_ns - status_ns >= kStatusInterval_ns) {
        status_ns = now_ns;
        remote_.publish(status());
      }
      if (now_ns - printed_ns >= kPrintInterval_ns) {
        if (printed_ns != 0) warn_of_patterns();  // a second for discovery
        printed_ns = now_ns;
        std::uint64_t lost = 0;
        for (const auto& [topic, counts] : recorded_->tally().topics({})) lost += counts.lost;
        print_progress(tape.status(), lost, now_ns - began_ns);
        required_.step(recorded_->tally().heard(), recorded_->trials().newest());
      }
      runtime::sleep_until_ns(now_ns + kPoll_ns);
    }
  }

  [[nodiscard]] stillhand_msgs::RecorderStatus status() {
    return status_of(remote_, recorded_->tape().status(), recorded_->tally().topics({}),
                     required_.missing());
  }

  const RecordOptions& options_;
  runtime::Stop& stop_;
  std::vector<FieldTrigger> triggers_;
  DefinedTypes defined_;
  RequiredTopics required_;
  std::mutex seen_;
  bool some_wanted_ = false;        ///< of the topics on the bus
  std::set<std::string> unwanted_;  ///< the other ones
  std::size_t unwanted_said_ = 0;   ///< of these
  std::optional<recording::BusRecording> recorded_;
  runtime::Tap tap_;  // its threads use the members above
  Remote remote_;
};

}  // namespace

int run_record(const RecordOptions& options, runtime::Stop& stop) {
  Run run(options, stop);
  return run();
}

}  // namespace stillhand::record
