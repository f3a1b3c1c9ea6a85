// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded_subjects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "apps/study/recorded/recorded_session.hpp"
#include "apps/study/recorded/selection.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::study {
namespace {

void read_session_of(const SessionFile& file, double least_share, Person& person,
                     RecordedSource& source) {
  RecordedSession session = read_recorded_session(file, least_share);
  if (session.identification) {
    person.identification = std::move(session.identification);
    person.identify_s = session.identify_s;
  }
  person.code = file.participant;
  if (session.simulated) source.simulated.insert(file.participant);
  person.broken_trials += session.broken_trials;
  for (RecordedTrial& trial : session.trials) {
    trial.place = static_cast<std::int64_t>(person.trials.size()) + 1;
    person.trials.push_back(std::move(trial));
  }
  std::ranges::move(session.pegged, std::back_inserter(source.pegged));
  std::ranges::move(session.left_out, std::back_inserter(source.left_out));
  if (session.plus_adds_nothing) {
    source.remarks.push_back(
        fmt::format("{}, session {}: C+ ran the model of C, since the "
                    "session's diagnosis found nothing certain to add",
                    file.participant, file.session));
  }
  if (!session.rig_parts.empty()) {
    source.remarks.push_back(
        fmt::format("{}, session {}: {}", file.participant, file.session, session.rig_parts));
  }
}

// Means over trials and people need one length.
void check_lengths(const std::vector<RecordedTrial>& trials) {
  const RecordedTrial& first = trials.front();
  for (const RecordedTrial& trial : trials) {
    const auto& metrics = trial.tracked.metrics;
    if (metrics.moving_rms_mm.size() == first.tracked.metrics.moving_rms_mm.size() &&
        metrics.lines[0].frequency_hz == first.tracked.metrics.lines[0].frequency_hz) {
      continue;
    }
    throw ConfigError(
        "--sessions",
        fmt::format("{}, session {}, trial {} with another length than {}'s trials",
                    trial.participant, trial.session, trial.number, first.participant),
        "tracking trials of one length");
  }
}

// All people of the recordings, by their codes.
std::vector<Person> people_of(const std::vector<SessionFile>& files, double least_share,
                              RecordedSource& source, const OnProgress& on_progress) {
  std::map<std::string, Person> people;
  std::set<std::string> excluded;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const SessionFile& file = files[i];
    if (file.excluded.empty()) {
      read_session_of(file, least_share, people[file.participant], source);
    } else if (excluded.insert(file.participant).second) {
      source.left_out.push_back(file.participant + ": excluded, " + file.excluded);
    }
    if (!on_progress(static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(files.size()))) {
      throw Interrupted();
    }
  }
  std::vector<Person> out;
  out.reserve(people.size());
  for (auto& [code, person] : people) out.push_back(std::move(person));
  return out;
}

// The first reason alone may be that of one person where the others lack something else.
void refuse_nobody(const Selection& selection, const std::vector<std::string>& why) {
  constexpr std::size_t kMostReasons = 6;
  if (!selection.results.empty()) return;
  const std::size_t shown = std::min(why.size(), kMostReasons);
  std::string reasons = fmt::format("{}", fmt::join(why.begin(), why.begin() + shown, "; "));
  if (shown < why.size()) reasons += fmt::format("; and {} more", why.size() - shown);
  throw ConfigError(
      "--sessions",
      "no complete participant (" + (why.empty() ? "no tracking trial" : reasons) + ")",
      "a pegged trial and the same conditions for each participant");
}

}  // namespace

void read_recorded(const std::vector<SessionFile>& files,
                   const std::optional<Registration>& registration, StudyRecord& record,
                   const OnProgress& on_progress) {
  RecordedSource source;
  source.digest = files.front().digest;
  const double least_share = registration ? kLeastShareBeforeRules : kLeastShare;
  std::vector<Person> people = people_of(files, least_share, source, on_progress);
  for (const Person& person : people) {
    std::ranges::copy(person.trials, std::back_inserter(source.trials));
  }
  if (!source.trials.empty()) check_lengths(source.trials);
  Selection selection = select(people);
  std::ranges::copy(selection.left_out, std::back_inserter(source.left_out));
  refuse_nobody(selection, source.left_out);
  if (registration) {
    source.simulated.clear();
    if (registration->design.who == "simulated") {
      for (const Person& person : people) source.simulated.insert(person.code);
    }
    Registered registered;
    registered.registration = *registration;
    registered.excluded = apply_rules(*registration, people);
    registered.without = std::move(selection);
    selection = select(people);
    // Who lacks a trial that a rule took away.
    for (const std::string& line : selection.left_out) {
      if (std::ranges::find(source.left_out, line) == source.left_out.end()) {
        registered.excluded.push_back(line);
      }
    }
    refuse_nobody(selection, registered.excluded);
    source.registered = std::move(registered);
  }
  std::ranges::move(selection.remarks, std::back_inserter(source.remarks));
  source.participants = std::move(selection.participants);
  source.used = std::move(selection.used);
  record.results = std::move(selection.results);
  record.options.subjects = static_cast<std::int64_t>(record.results.size());
  const auto& line = record.results.front().trials.begin()->second.metrics.lines[0];
  record.options.protocol.trial_s = static_cast<double>(line.harmonic) / line.frequency_hz;
  record.options.protocol.identify_s =
      std::ranges::find(people, source.participants.front(), &Person::code)->identify_s;
  record.recorded = std::move(source);
}

}  // namespace stillhand::study
