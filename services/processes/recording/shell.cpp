// SPDX-License-Identifier: Apache-2.0
#include "services/processes/recording/shell.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "idl/session_state.hpp"
#include "services/bus/recording/session_texts.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"
#include "services/system/process/log_clock.hpp"

namespace stillhand::recording {
namespace {

constexpr std::int64_t kWatch_ns = 20'000'000;

TapeOptions options_of(const runtime::ServiceOptions& service, const KeepOptions& keep,
                       const OfExperiment& place) {
  TapeOptions options = tape_options(keep, service.out.string());
  options.session = session_texts(service.domain, "stillhand-recorder");
  options.session["rig"] = std::to_string(service.rig);
  options.session["seed"] = std::to_string(service.seed);
  if (!place.participant.empty()) {
    options.first_words.push_back({kExperimentRecord, experiment_texts(place)});
  }
  return options;
}

}  // namespace

Shell::Shell(runtime::Service& service, const KeepOptions& keep, const OfExperiment& place)
    : service_(service) {
  for (const topics::Topic* topic : topics::kCatalogue) subscribe(*topic);
  recording_.emplace(options_of(service.options(), keep, place));
  service.on_trial([this](const Trial& trial, const auto& control) {
    service_.note_armed(trial.number);
    if (trial.phase != TrialPhase::kIdle) {
      end_tick_ = trial.start_tick + trial.duration_ticks + trial.ramp_ticks;
    }
    if (is_running(control.session())) report_file();
  });
}

// Once this session knows its sources: it believes nobody else.
void Shell::report_file() {
  if (!service_.options().one_session || std::exchange(reported_file_, true)) return;
  const std::string file = std::filesystem::absolute(service_.options().out).string();
  service_.note_event(stillhand_msgs::EVENT_NOTE,
                      (std::string(topics::kRecordingNote) + file).c_str());
}

void Shell::subscribe(const topics::Topic& topic) {
  const bool stream = topic.pattern == topics::Pattern::kStream1khz;
  const bool truth = &topic == &topics::kRigTruth;  // the last that the rig writes of a tick
  // A recording is read by the names of its own session: those of another experiment are left out.
  const std::string& wanted = service_.options().experiment;
  std::optional<runtime::ParticipantId> naming;
  if (&topic == &topics::kSessionSources && !wanted.empty()) {
    naming = runtime::participant_of(wanted, "--experiment");
  }
  service_.bus().subscribe_serialized(
      topic,
      [this, stream, truth, naming](
          std::span<const std::byte> bytes,
          const runtime::Arrival& arrival) -> runtime::detail::SampleClock {
        if (naming && arrival.participant != *naming) return {true, -1, 0};
        if (arrival.writer != nullptr) {
          recording_->take(*arrival.writer,
                           {arrival.writer_number, arrival.sequence, arrival.source_ns,
                            runtime::log_ns(arrival.received_ns), arrival.received_ns, bytes});
        } else {
          unattributed_.fetch_add(1, std::memory_order_relaxed);
        }
        // What a stranger writes is recorded, too; the session's ticks are its sources'.
        const SampleHead head = stream && !arrival.foreign ? sample_head(bytes) : SampleHead{};
        if (head.tick >= 0) service_.note_tick(head.tick);
        if (head.tick >= 0 && truth) rig_tick_.store(head.tick, std::memory_order_relaxed);
        return {true, head.tick, head.stamp_ns};
      });
}

// An unrecorded trial is not valid: the process ends with the tape, and run() reports the reason.
void Shell::watch() {
  while (!service_.stop().requested() && !recording_->tape().stopped()) {
    runtime::sleep_until_ns(runtime::monotonic_ns() + kWatch_ns);
    keep_trial();
  }
  if (service_.options().one_session) see_others_out();
  if (recording_->tape().stopped()) {
    service_.note_event(stillhand_msgs::EVENT_NOTE,
                        "recording stopped: the file cannot be written");
  }
}

// A power failure takes nothing of a trial that counts.
void Shell::keep_trial() {
  constexpr Tick kLate_ticks = 50;  // of the other streams
  const Tick end = end_tick_;
  if (end == kept_tick_ || rig_tick_.load(std::memory_order_relaxed) < end + kLate_ticks) return;
  kept_tick_ = end;
  if (!recording_->tape().sync()) return;
  service_.note_event(stillhand_msgs::EVENT_NOTE, "the trial is on the disk", 0.0,
                      stillhand_msgs::CODE_RECORDED);
}

// The last messages of the other processes belong to the session.
void Shell::see_others_out() {
  constexpr std::int64_t kPatience_ns = 3'000'000'000;
  constexpr std::size_t kOthers = topics::kServices.size() - 2;  // without recorder and experiment
  const std::int64_t limit_ns = runtime::monotonic_ns() + kPatience_ns;
  while (runtime::monotonic_ns() < limit_ns && service_.bus().lost_peers().size() < kOthers) {
    runtime::sleep_until_ns(runtime::monotonic_ns() + kWatch_ns);
  }
}

void Shell::run() {
  Status closed;
  service_.run([&] {
    watch();
    if (!service_.options().one_session) return;
    // The life sign continues until the file is complete: its end shows that the file is ready.
    recording_->tape().set_paused(true);  // later messages do not belong to the session
    closed = recording_->tape().close();
  });
  if (!service_.options().one_session) closed = recording_->tape().close();
  if (!closed.ok()) throw std::runtime_error(closed.text);
  const TapeStatus end = recording_->tape().status();
  const std::uint64_t missing = end.dropped + unattributed_.load(std::memory_order_relaxed);
  if (missing > 0) {
    throw std::runtime_error(end.file + ": " + std::to_string(missing) +
                             " received messages not written");
  }
}

}  // namespace stillhand::recording
