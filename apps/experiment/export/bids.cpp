// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/bids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/experiment/export/bids_texts.hpp"
#include "apps/experiment/export/set_files.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::experiment {
namespace {

constexpr const char* kNone = "n/a";

std::string cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : kNone; }
std::string cell(std::int64_t value) { return value > 0 ? std::to_string(value) : kNone; }
const char* cell(bool value) { return value ? "yes" : "no"; }

std::string motion_tsv(const recording::Recording& rows) {
  std::string text;
  for (std::size_t n = 0; n < rows.row_count(); ++n) {
    for (std::size_t c = 0; c < rows.columns.size(); ++c) {
      const double value = rows.columns[c].values[n];
      if (c > 0) text += '\t';
      if (std::isfinite(value)) {
        fmt::format_to(std::back_inserter(text), "{}", value);
      } else {
        text += kNone;
      }
    }
    text += '\n';
  }
  return text;
}

std::string trials_row(const ExportedTrial& trial) {
  std::string row = fmt::format("{:02}\t{}\t{}\t{}\t{}\t{}", trial.trial.number, cell(trial.block),
                                cell(trial.place), trial.condition, cell(trial.completed),
                                cell(trial.lost_share));
  for (const session::Number& each : session::numbers(session::kExport)) {
    row += "\t" + (trial.metrics ? cell((*trial.metrics).*each.place.metric) : std::string(kNone));
  }
  return row + "\n";
}

std::string trials_tsv(const ExportedParticipant& participant, std::int64_t session,
                       TrialKind kind) {
  std::string text;
  for (const ExportedTrial& trial : participant.trials) {
    if (trial.session == session && trial.kind == kind) text += trials_row(trial);
  }
  if (text.empty()) return text;
  std::string header = "run\tblock\tplace\tcondition\tcompleted\tlost_share";
  for (const session::Number& each : session::numbers(session::kExport)) {
    header += std::string("\t") + each.name;
  }
  return header + "\n" + text;
}

std::string answers_tsv(const ExportedParticipant& participant, std::int64_t session) {
  std::string text;
  for (const ExportedAnswer& each : participant.answers) {
    if (each.session != session) continue;
    text += fmt::format("{}\t{}\t{}\n", each.block, each.question, each.answer);
  }
  return text.empty() ? text : "block\tquestion\tanswer\n" + text;
}

std::string participants_tsv(const DataSet& set) {
  std::string text = "participant_id\texcluded\tsessions\ttrials\torder\tsimulated\n";
  for (const ExportedParticipant& each : set.participants) {
    std::int64_t trials = 0;
    std::string order;
    for (const ExportedTrial& trial : each.trials) {
      if (trial.kind != TrialKind::kTracking || !trial.completed) continue;
      ++trials;
      order += (order.empty() ? "" : " ") + trial.condition;
    }
    text += fmt::format("sub-{}\t{}\t{}\t{}\t{}\t{}\n", each.code, cell(each.excluded),
                        each.sessions.size(), trials, order.empty() ? kNone : order,
                        cell(each.simulated));
  }
  return text;
}

// One run: samples, channels, side file, event.
void write_run(SetFiles& files, const Folder& folder, const ExportedParticipant& participant,
               const ExportedTrial& trial, const std::string& session) {
  const recording::Recording rows = rows_of(folder, participant, trial);
  const std::string run =
      fmt::format("{}/motion/sub-{}_{}_task-{}_tracksys-rig_run-{:02}", session, participant.code,
                  session.substr(session.find('/') + 1), name_of(trial.kind), trial.trial.number);
  files.write(run + "_motion.tsv", motion_tsv(rows));
  files.write(run + "_motion.json", motion_json(folder.design(), trial, rows));
  files.write(run + "_channels.tsv", channels_tsv(rows));
  if (trial.condition.empty()) return;
  files.write(run + "_events.tsv",
              fmt::format("onset\tduration\ttrial_type\n0\t{}\t{}\n",
                          static_cast<double>(rows.row_count()) / rows.rate_hz, trial.condition));
}

void write_session(SetFiles& files, const Folder& folder, const ExportedParticipant& participant,
                   std::int64_t session, std::vector<std::string>& left_out) {
  const std::string place = fmt::format("sub-{}/ses-{:02}", participant.code, session);
  for (const ExportedTrial& trial : participant.trials) {
    if (trial.session != session) continue;
    try {
      write_run(files, folder, participant, trial, place);
    } catch (const ConfigError& error) {
      left_out.push_back(
          fmt::format("{}, session {:02}: {}", participant.code, session, error.what()));
    }
  }
  const auto beh = [&](const std::string& task, const std::string& text) {
    if (text.empty()) return;
    files.write(fmt::format("{}/beh/sub-{}_ses-{:02}_task-{}_beh.tsv", place, participant.code,
                            session, task),
                text);
  };
  for (const TrialKind kind : {TrialKind::kPractice, TrialKind::kTracking}) {
    beh(name_of(kind), trials_tsv(participant, session, kind));
  }
  beh("questions", answers_tsv(participant, session));
}

void write_top(SetFiles& files, const DataSet& set, const Folder& folder, const Release& release) {
  const Design& design = folder.design();
  files.write("dataset_description.json", dataset_description(design, release));
  files.write("README", readme(folder, set, release));
  files.write("CHANGES", changes(set));
  files.write(".bidsignore", std::string(kSumsFile) + "\n");
  files.write("participants.tsv", participants_tsv(set));
  files.write("participants.json", participants_json());
  files.write("sourcedata/experiment.yaml", registered_text(folder.path()));
  const auto has = [&](auto wanted) { return std::ranges::any_of(set.participants, wanted); };
  for (const TrialKind kind : {TrialKind::kPractice, TrialKind::kTracking}) {
    if (!has([kind](const auto& each) {
          return std::ranges::find(each.trials, kind, &ExportedTrial::kind) != each.trials.end();
        })) {
      continue;
    }
    const std::string task = fmt::format("task-{}", name_of(kind));
    files.write(task + "_beh.json", trials_json(kind));
    files.write(task + "_events.json", events_json());
  }
  if (has([](const auto& each) { return !each.answers.empty(); })) {
    files.write("task-questions_beh.json", answers_json(design));
  }
}

}  // namespace

std::vector<std::string> write_bids(const DataSet& set, const Folder& folder,
                                    const Release& release, report::StagedFolder& out,
                                    const OnSession& on_participant) {
  SetFiles files(out);
  std::vector<std::string> left_out;
  write_top(files, set, folder, release);
  std::int64_t done = 0;
  for (const ExportedParticipant& participant : set.participants) {
    for (const std::int64_t session : participant.sessions) {
      write_session(files, folder, participant, session, left_out);
    }
    if (!on_participant(++done, static_cast<std::int64_t>(set.participants.size()))) {
      throw study::Interrupted();
    }
  }
  files.write_sums();
  return left_out;
}

}  // namespace stillhand::experiment
