// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/data_set.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "apps/experiment/folder/sealed_assignment.hpp"
#include "apps/libraries/measurement/session.hpp"
#include "apps/libraries/measurement/session_trials.hpp"
#include "apps/study/recorded/recorded_session.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::experiment {
namespace {

// What the journal says of the trials of a participant.
using JournalTrials = std::map<std::pair<std::int64_t, std::int64_t>, Entry>;

JournalTrials trials_in(const std::vector<Entry>& entries) {
  JournalTrials out;
  for (const Entry& entry : entries) {
    const bool of_trial =
        entry.kind == EntryKind::kTrialBegan || entry.kind == EntryKind::kTrialEnded;
    if (of_trial) out[{entry.session, entry.trial}] = entry;
  }
  return out;
}

bool identifies(TrialKind kind) {
  return kind == TrialKind::kIdentification || kind == TrialKind::kFreeIdentification;
}

// Facts that only the plan and the journal have.
void add_plan(ExportedTrial& out, const Folder& folder, const Plan& plan, const Entry& entry) {
  out.completed = entry.kind == EntryKind::kTrialEnded && entry.completed;
  if (identifies(out.kind)) return;
  const Step& step = plan.at(static_cast<std::size_t>(entry.step));
  if (step.kind == StepKind::kPractice) {
    out.kind = TrialKind::kPractice;
    out.condition = "A";
    return;
  }
  out.block = step.block;
  out.place = step.place;
  out.condition = folder.design().conditions.at(step.condition);
}

ExportedTrial trial_of(const Folder& folder, const Plan& plan, const std::string& file,
                       std::int64_t session, const measurement::SessionTrial& found,
                       const JournalTrials& known) {
  ExportedTrial out;
  out.session = session;
  out.trial = found.trial;
  out.end_tick = found.end_tick;
  const auto planned = static_cast<double>(found.trial.duration_ticks);
  out.lost_share = 1.0 - static_cast<double>(found.recorded_ticks) / planned;
  if (found.trial.phase == TrialPhase::kPegged) out.kind = TrialKind::kIdentification;
  if (found.trial.phase == TrialPhase::kFree) out.kind = TrialKind::kFreeIdentification;
  const auto entry = known.find({session, found.trial.number});
  // The journal names an identification that was asked again by its last number alone.
  if (entry == known.end() && identifies(out.kind)) return out;
  if (entry == known.end() || (!identifies(out.kind) && entry->second.step < 0)) {
    throw ConfigError(file, "trial " + found.name() + ", which the journal does not know",
                      "the folder as the sessions left it");
  }
  add_plan(out, folder, plan, entry->second);
  // C' and C+ are C with another model.
  const bool same =
      found.named.empty() ? out.condition.front() == found.letter : out.condition == found.named;
  if (!identifies(out.kind) && !same) {
    throw ConfigError(file, "trial " + found.name(),
                      "condition " + out.condition + ", as journal and assignment say");
  }
  return out;
}

void add_metrics(ExportedParticipant& participant, std::int64_t session,
                 const std::vector<study::RecordedTrial>& recorded) {
  for (const study::RecordedTrial& each : recorded) {
    for (ExportedTrial& trial : participant.trials) {
      if (trial.session != session || trial.trial.number != each.number) continue;
      trial.metrics = each.tracked.metrics;
      if (name_of(each.condition) == trial.condition) continue;
      // C, C' and C+ differ in the model that the motor used.
      throw ConfigError(
          fmt::format("{}, session {:02}, trial {}", participant.code, session, each.number),
          std::string("condition ") + name_of(each.condition) + " in the recording",
          trial.condition + ", as journal and assignment say");
    }
  }
}

void add_session(ExportedParticipant& participant, const Folder& folder, const Plan& plan,
                 std::int64_t session, const JournalTrials& known) {
  const std::filesystem::path file = folder.session(participant.index, session) / "session.mcap";
  if (!std::filesystem::exists(file)) return;
  recording::FileSource source(file.string());
  recording::McapReader reader(source);
  const auto found = measurement::find_trials(reader, file.string());
  participant.sessions.push_back(session);
  for (const measurement::SessionTrial& trial : found.trials) {
    participant.trials.push_back(trial_of(folder, plan, file.string(), session, trial, known));
  }
  const study::RecordedSession recorded = study::read_recorded_session(
      {file, participant.code, fmt::format("{:02}", session), folder.digest(), ""},
      study::kLeastShareBeforeRules);
  add_metrics(participant, session, recorded.trials);
  add_metrics(participant, session, recorded.practice);
  for (ExportedTrial& trial : participant.trials) {
    const bool other = recorded.other_model.contains(trial.trial.number);
    if (trial.session == session && other) trial.condition = kOtherModel;
  }
}

// A file that was cut off behind its session would take trials out of the data set without a word.
void require_completed(const ExportedParticipant& participant, const JournalTrials& known) {
  for (const auto& [place, entry] : known) {
    if (entry.kind != EntryKind::kTrialEnded || !entry.completed) continue;
    const bool there = std::ranges::any_of(participant.trials, [&](const ExportedTrial& each) {
      return each.session == place.first && each.trial.number == place.second;
    });
    if (there) continue;
    throw ConfigError(fmt::format("{}, session {:02}", participant.code, place.first),
                      fmt::format("no trial {} in session.mcap", place.second),
                      "the recording of every trial that the journal calls completed");
  }
}

void add_answers(ExportedParticipant& participant, const Folder& folder, const Plan& plan,
                 const std::vector<Entry>& entries) {
  for (const Entry& entry : entries) {
    if (entry.kind != EntryKind::kQuestionAnswered || entry.answer == 0) continue;
    const Step& step = plan.at(static_cast<std::size_t>(entry.step));
    participant.answers.push_back({entry.session, step.block,
                                   folder.design().questions.at(step.question).name, entry.answer});
  }
}

// "2026-11-25" of the first line of the folder's journal that opened all conditions.
std::string day_of_unblinding(const Folder& folder) {
  for (const Entry& entry : read_journal(folder.path() / "journal.jsonl")) {
    if (entry.participant.empty()) return entry.time.substr(0, 10);
  }
  return "n/a";
}

}  // namespace

const char* name_of(TrialKind kind) {
  constexpr std::array kNames{"identification", "freestick", "practice", "tracking"};
  return kNames.at(static_cast<std::size_t>(kind));
}

DataSet data_set_of(const Folder& folder, const OnSession& on_session) {
  if (!folder.unblinded()) {
    throw ConfigError(folder.path().string(), "an experiment that is still blinded",
                      "`" + command_for("unblind", folder.path()) + "` first");
  }
  folder.refuse_findings();
  DataSet out;
  out.released = day_of_unblinding(folder);
  const std::vector<std::size_t> indices = folder.participants();
  bool any = false;
  for (const std::size_t index : indices) {
    const std::vector<Entry> entries = read_journal(folder.journal(index));
    const Plan plan = folder.plan(index);
    Progress progress(folder.design(), plan);
    for (const Entry& entry : entries) progress.take(entry);
    ExportedParticipant participant;
    participant.index = index;
    participant.code = participant_code(index);
    participant.excluded = !progress.excluded().empty();
    participant.simulated = folder.design().who == "simulated";
    const JournalTrials known = trials_in(entries);
    for (std::int64_t session = 1; session <= progress.sessions(); ++session) {
      add_session(participant, folder, plan, session, known);
    }
    require_completed(participant, known);
    add_answers(participant, folder, plan, entries);
    any = any || !participant.trials.empty();
    out.participants.push_back(std::move(participant));
    const auto done = static_cast<std::int64_t>(out.participants.size());
    if (!on_session(done, static_cast<std::int64_t>(indices.size()))) throw study::Interrupted();
  }
  if (!any) {
    throw ConfigError(folder.path().string(), "an experiment without a recorded trial",
                      "one session of one participant or more");
  }
  return out;
}

recording::Recording rows_of(const Folder& folder, const ExportedParticipant& participant,
                             const ExportedTrial& trial) {
  const std::filesystem::path file =
      folder.session(participant.index, trial.session) / "session.mcap";
  recording::Recording found =
      measurement::read_session_rows(file.string(), std::to_string(trial.trial.number)).rows;
  recording::Recording out;
  out.rate_hz = kControlRateHz;
  out.source = found.source;
  const auto ticks = static_cast<std::size_t>(trial.end_tick - trial.trial.start_tick);
  for (std::size_t n = 0; n < ticks; ++n) {
    out.time_s.push_back(static_cast<double>(n) / kControlRateHz);
  }
  for (const recording::Column& column : found.columns) {
    out.columns.push_back({column.name, column.unit,
                           std::vector<double>(ticks, std::numeric_limits<double>::quiet_NaN())});
  }
  for (std::size_t row = 0; row < found.row_count(); ++row) {
    const Tick tick = std::llround(found.time_s[row] * kControlRateHz);
    const auto at = static_cast<std::size_t>(tick - trial.trial.start_tick);
    for (std::size_t c = 0; c < out.columns.size(); ++c) {
      out.columns[c].values.at(at) = found.columns[c].values[row];
    }
  }
  return out;
}

}  // namespace stillhand::experiment
