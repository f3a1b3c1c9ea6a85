// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/recorded_subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "apps/study/recorded/recorded_session.hpp"
#include "services/contract/config_error.hpp"

namespace stillhand::study {
namespace {

// All that the sessions of one participant give.
struct Participant {
  std::optional<Identification> identification;
  double identify_s = 0.0;
  std::vector<RecordedTrial> trials;
};

void read_session_of(const SessionFile& file, Participant& participant, RecordedSource& source) {
  RecordedSession session = read_recorded_session(file);
  if (session.control_model) {
    throw ConfigError(file.path.string(), "a session whose motor used a control model (C+)",
                      "sessions of conditions A, B and C");
  }
  if (session.identification) {
    participant.identification = std::move(session.identification);
    participant.identify_s = session.identify_s;
  }
  for (RecordedTrial& trial : session.trials) {
    trial.place = static_cast<std::int64_t>(participant.trials.size()) + 1;
    participant.trials.push_back(std::move(trial));
  }
  std::ranges::move(session.left_out, std::back_inserter(source.left_out));
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
