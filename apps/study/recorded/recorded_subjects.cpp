// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/recorded_subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "apps/measurement/session_trials.hpp"
#include "apps/session/measured_ticks.hpp"
#include "apps/session/session_recording.hpp"
#include "apps/study/trial_analysis.hpp"
#include "services/contract/config_error.hpp"
#include "services/contract/flag.hpp"
#include "services/recording/core/mcap/mcap_reader.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::study {
namespace {

using measurement::SessionTrial;
using session::SessionRecording;

// Least share of a trial's ticks that a complete one has.
constexpr double kLeastShare = 0.99;

// All that the sessions of one participant give.
struct Participant {
  std::optional<Identification> identification;
  double identify_s = 0.0;
  std::vector<RecordedTrial> trials;
};

measurement::SessionTrials trials_of(const SessionFile& file) {
  recording::FileSource source(file.path.string());
  recording::McapReader reader(source);
  return measurement::find_trials(reader, file.path.string());
}

// Why the trial cannot count, or empty.
std::string incomplete(const SessionTrial& trial) {
  const Tick planned = trial.trial.duration_ticks;
  if (trial.end_tick < trial.trial.start_tick + planned) return "was ended early";
  if (static_cast<double>(trial.recorded_ticks) < kLeastShare * static_cast<double>(planned)) {
    return fmt::format("has {} of {} samples", trial.recorded_ticks, planned);
  }
  return "";
}

// Samples of other rigs, and those that hold an earlier value, go.
void keep_valid(SessionRecording& recorded, std::uint32_t rig) {
  constexpr Flags kNotMeasured = Flag::kInputInvalid | Flag::kFault;
  std::erase_if(recorded.sensed, [&](const auto& m) {
    return m.rig() != rig || (m.flags() & kNotMeasured) != 0 ||
           !std::isfinite(m.accel_y_m_s2() + m.force_n());
  });
  std::erase_if(recorded.tracking_samples, [&](const auto& m) {
    return m.rig() != rig || !std::isfinite(m.target_m() + m.cursor_m());
  });
  std::erase_if(recorded.rig_truths, [&](const auto& m) { return m.rig() != rig; });
}

template <typename Message, typename Value>
std::vector<double> kept(const std::vector<Message>& stream, const Trial& trial, Tick every,
                         Value value) {
  std::int64_t missing = 0;
  const std::vector<double> all = session::measured(stream, trial, value, missing);
  if (static_cast<double>(missing) >
      (1.0 - kLeastShare) * static_cast<double>(trial.duration_ticks)) {
    throw ConfigError("trial " + std::to_string(trial.number),
                      fmt::format("{} of {} samples missing", missing, trial.duration_ticks),
                      "a trial without gaps");
  }
  std::vector<double> out;
  for (std::size_t n = 0; n < all.size(); n += static_cast<std::size_t>(every)) {
    out.push_back(all[n]);
  }
  return out;
}

Identification identified_from(const SessionRecording& recorded, const Trial& trial) {
  identification::Record pegged;
  pegged.rate_hz = kControlRateHz;
  pegged.acceleration_m_s2 =
      kept(recorded.sensed, trial, 1, [](const auto& m) { return m.accel_y_m_s2(); });
  pegged.force_n = kept(recorded.sensed, trial, 1, [](const auto& m) { return m.force_n(); });
  return identified(pegged);
}

TrackedTrial tracked_from(const SessionRecording& recorded, const SessionTrial& found) {
  const auto of = [&](const auto& stream, auto value) {
    return kept(stream, found.trial, kKeepEvery, value);
  };
  session::TrialSignals signals;
  signals.tracking.rate_hz = kControlRateHz / static_cast<double>(kKeepEvery);
  signals.tracking.target_m =
      of(recorded.tracking_samples, [](const auto& m) { return m.target_m(); });
  signals.tracking.cursor_m =
      of(recorded.tracking_samples, [](const auto& m) { return m.cursor_m(); });
  // The truth of a simulated rig; of a rig of devices the feedthrough is not known, and is NaN.
  signals.feedthrough_n =
      of(recorded.rig_truths, [](const auto& m) { return m.feedthrough_force_n(); });
  signals.motor_n = of(recorded.rig_truths, [](const auto& m) { return m.motor_force_n(); });
  session::PlannedTrial planned{};
  planned.trial = found.trial;
  planned.label = found.letter;
  planned.cancellation = found.letter == 'C';
  return evaluated(signals, planned);
}

// The trials that an experiment announced as practice, by a note before each
// (apps/experiment/README.md).
std::set<std::int64_t> practice_of(const SessionRecording& recorded) {
  std::set<std::int64_t> numbers;
  for (const auto& event : recorded.events) {
    constexpr std::string_view kBegin = "experiment: trial ";
    const std::string text = event.text().c_str();
    const bool note = event.kind() == stillhand_msgs::EVENT_NOTE && event.source() == "experiment";
    if (!note || !text.starts_with(kBegin) || !text.ends_with(", practice")) continue;
    std::int64_t number = -1;
    const char* digits = text.data() + kBegin.size();
    if (std::from_chars(digits, text.data() + text.size(), number).ec == std::errc()) {
      numbers.insert(number);
    }
  }
  return numbers;
}

void read_session_of(const SessionFile& file, Participant& participant, RecordedSource& source) {
  const measurement::SessionTrials trials = trials_of(file);
  SessionRecording recorded = session::read_session(file.path.string());
  if (!recorded.control_models.empty()) {
    throw ConfigError(file.path.string(), "a session whose motor used a control model (C+)",
                      "sessions of conditions A, B and C");
  }
  keep_valid(recorded, trials.rig);
  const std::set<std::int64_t> practice = practice_of(recorded);
  for (const SessionTrial& trial : trials.trials) {
    if (practice.contains(trial.trial.number)) continue;
    const std::string where =
        fmt::format("{}, session {}, trial {}", file.participant, file.session, trial.name());
    std::string why = trial.letter == '?' ? "has no condition" : incomplete(trial);
    try {
      if (!why.empty()) {
      } else if (trial.letter == 'I') {
        participant.identification = identified_from(recorded, trial.trial);
        participant.identify_s = static_cast<double>(trial.trial.duration_ticks) * kControlPeriod_s;
      } else {
        participant.trials.push_back({file.participant, file.session, trial.trial.number,
                                      static_cast<std::int64_t>(participant.trials.size()) + 1,
                                      trial.letter, tracked_from(recorded, trial)});
      }
    } catch (const ConfigError& error) {
      why = error.what();
    }
    if (!why.empty()) source.left_out.push_back(fmt::format("{}: {}", where, why));
  }
}

// The conditions that most participants have.
std::string wanted_conditions(const std::map<std::string, Participant>& people) {
  std::map<char, std::size_t> count;
  for (const auto& [code, participant] : people) {
    std::set<char> own;
    for (const RecordedTrial& trial : participant.trials) own.insert(trial.condition);
    for (const char condition : own) ++count[condition];
  }
  std::string out;
  for (const auto& [condition, number] : count) {
    if (2 * number > people.size()) out += condition;
  }
  return out;
}

SubjectResult result_of(const Participant& participant, const std::string& conditions) {
  SubjectResult out;
  out.identification = *participant.identification;
  std::map<char, const RecordedTrial*> last;
  for (const RecordedTrial& trial : participant.trials) {
    if (conditions.find(trial.condition) != std::string::npos) last[trial.condition] = &trial;
  }
  std::map<std::int64_t, char> order;
  for (const auto& [condition, trial] : last) {
    out.trials[condition] = trial->tracked;
    order[trial->place] = condition;
  }
  for (const auto& [place, condition] : order) out.order += condition;
  return out;
}

// Why a participant cannot be in the tables, or empty.
std::string lacking(const Participant& participant, const std::string& conditions) {
  if (!participant.identification) return "no complete pegged trial";
  for (const char condition : conditions) {
    if (std::ranges::find(participant.trials, condition, &RecordedTrial::condition) ==
        participant.trials.end()) {
      return fmt::format("no complete trial of condition {}", condition);
    }
  }
  return "";
}

void check_lengths(const std::vector<SubjectResult>& results, const RecordedSource& source) {
  const auto& first = results.front().trials.begin()->second.metrics;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const auto& [condition, trial] : results[i].trials) {
      if (trial.metrics.moving_rms_mm.size() == first.moving_rms_mm.size() &&
          trial.metrics.lines[0].frequency_hz == first.lines[0].frequency_hz) {
        continue;
      }
      throw ConfigError("--sessions",
                        fmt::format("condition {} of {} with another length than {}'s trials",
                                    condition, source.participants[i], source.participants.front()),
                        "tracking trials of one length");
    }
  }
}

}  // namespace

void read_recorded(const std::vector<SessionFile>& files, StudyRecord& record,
                   const OnProgress& on_progress) {
  RecordedSource source;
  source.digest = files.front().digest;
  std::map<std::string, Participant> people;
  std::set<std::string> excluded;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const SessionFile& file = files[i];
    if (file.excluded.empty()) {
      read_session_of(file, people[file.participant], source);
    } else if (excluded.insert(file.participant).second) {
      source.left_out.push_back(file.participant + ": excluded, " + file.excluded);
    }
    if (!on_progress(static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(files.size()))) {
      throw Interrupted();
    }
  }
  const std::string conditions = wanted_conditions(people);
  for (const auto& [code, participant] : people) {
    std::ranges::copy(participant.trials, std::back_inserter(source.trials));
    const std::string why = lacking(participant, conditions);
    if (!why.empty()) {
      source.left_out.push_back(fmt::format("{}: {}", code, why));
      continue;
    }
    source.participants.push_back(code);
    record.results.push_back(result_of(participant, conditions));
  }
  if (record.results.empty() || conditions.empty()) {
    const std::string why = source.left_out.empty() ? "no tracking trial" : source.left_out.back();
    throw ConfigError("--sessions", "no complete participant (" + why + ")",
                      "a pegged trial and the same conditions for each participant");
  }
  check_lengths(record.results, source);
  record.options.subjects = static_cast<std::int64_t>(record.results.size());
  const auto& line = record.results.front().trials.begin()->second.metrics.lines[0];
  record.options.protocol.trial_s = static_cast<double>(line.harmonic) / line.frequency_hz;
  record.options.protocol.identify_s = people.at(source.participants.front()).identify_s;
  record.recorded = std::move(source);
}

}  // namespace stillhand::study
