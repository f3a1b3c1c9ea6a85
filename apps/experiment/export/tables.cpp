// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "apps/libraries/session/core/trial_numbers.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::experiment {
namespace {

using recording::Cell;
using recording::CellKind;
using recording::MessageColumn;

// One table on its way out.
class Table {
 public:
  Table(recordings::TableFile& file, const std::string& name, const std::string& title,
        std::vector<MessageColumn> columns)
      : sink_(file.add({name, title, "table", std::move(columns), false}, 0)) {}

  void add(const std::vector<Cell>& cells) { sink_->take({0, 0, 0, 0, cells}); }
  void finish() { sink_->finish(); }

 private:
  std::unique_ptr<recordings::TableSink> sink_;
};

// Nothing where there is no number.
Cell real_cell(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

std::string session_name(std::int64_t session) { return fmt::format("{:02}", session); }

void write_participants(const DataSet& set, recordings::TableFile& file) {
  Table table(file, "participants", "participants",
              {{"participant", "-", CellKind::kText},
               {"excluded", "-", CellKind::kInteger},
               {"sessions", "-", CellKind::kInteger},
               {"simulated", "-", CellKind::kInteger}});
  for (const ExportedParticipant& each : set.participants) {
    table.add({std::string_view(each.code), std::int64_t{each.excluded},
               static_cast<std::int64_t>(each.sessions.size()), std::int64_t{each.simulated}});
  }
  table.finish();
}

void write_trials(const DataSet& set, recordings::TableFile& file) {
  std::vector<MessageColumn> columns{
      {"participant", "-", CellKind::kText}, {"session", "-", CellKind::kText},
      {"trial", "-", CellKind::kInteger},    {"task", "-", CellKind::kText},
      {"block", "-", CellKind::kInteger},    {"place", "-", CellKind::kInteger},
      {"condition", "-", CellKind::kText},   {"completed", "-", CellKind::kInteger},
      {"lost_share", "-", CellKind::kReal}};
  for (const session::Number& number : session::numbers(session::kExport)) {
    columns.push_back({number.name, std::string(number.unit()), CellKind::kReal});
  }
  Table table(file, "trials", "trials", std::move(columns));
  for (const ExportedParticipant& each : set.participants) {
    for (const ExportedTrial& trial : each.trials) {
      const std::string session = session_name(trial.session);
      std::vector<Cell> row{std::string_view(each.code),
                            std::string_view(session),
                            trial.trial.number,
                            std::string_view(name_of(trial.kind)),
                            trial.block,
                            trial.place,
                            std::string_view(trial.condition),
                            std::int64_t{trial.completed},
                            trial.lost_share};
      for (const session::Number& number : session::numbers(session::kExport)) {
        row.push_back(trial.metrics ? real_cell((*trial.metrics).*number.place.metric) : Cell());
      }
      table.add(row);
    }
  }
  table.finish();
}

void write_answers(const DataSet& set, recordings::TableFile& file) {
  if (std::ranges::all_of(set.participants,
                          [](const auto& each) { return each.answers.empty(); })) {
    return;
  }
  Table table(file, "answers", "answers",
              {{"participant", "-", CellKind::kText},
               {"session", "-", CellKind::kText},
               {"block", "-", CellKind::kInteger},
               {"question", "-", CellKind::kText},
               {"answer", "-", CellKind::kInteger}});
  for (const ExportedParticipant& each : set.participants) {
    for (const ExportedAnswer& answer : each.answers) {
      const std::string session = session_name(answer.session);
      table.add({std::string_view(each.code), std::string_view(session), answer.block,
                 std::string_view(answer.question), answer.answer});
    }
  }
  table.finish();
}

// The CSV format of recordings (services/processes/recording/README.md): a lost sample is a missing
// row.
void write_samples(const Folder& folder, const ExportedParticipant& participant,
                   const ExportedTrial& trial, recordings::TableFile& file) {
  const recording::Recording rows = rows_of(folder, participant, trial);
  std::vector<MessageColumn> columns{{"t", "s", CellKind::kReal}};
  for (const recording::Column& column : rows.columns) {
    columns.push_back({column.name, column.unit, CellKind::kReal});
  }
  const std::string name = fmt::format("{}_session_{:02}_trial_{:02}", participant.code,
                                       trial.session, trial.trial.number);
  Table table(file, name, name, columns);
  std::vector<Cell> cells(columns.size());
  for (std::size_t n = 0; n < rows.row_count(); ++n) {
    if (std::isnan(rows.columns.front().values[n])) continue;
    cells[0] = rows.time_s[n];
    for (std::size_t c = 0; c < rows.columns.size(); ++c) {
      cells[c + 1] = rows.columns[c].values[n];
    }
    table.add(cells);
  }
  table.finish();
}

}  // namespace

std::vector<std::string> write_tables(const DataSet& set, const Folder& folder,
                                      recordings::TableFile& file,
                                      const OnSession& on_participant) {
  std::vector<std::string> left_out;
  write_participants(set, file);
  write_trials(set, file);
  write_answers(set, file);
  std::int64_t done = 0;
  for (const ExportedParticipant& participant : set.participants) {
    for (const ExportedTrial& trial : participant.trials) {
      try {
        write_samples(folder, participant, trial, file);
      } catch (const ConfigError& error) {
        left_out.push_back(
            fmt::format("{}, session {:02}: {}", participant.code, trial.session, error.what()));
      }
    }
    if (!on_participant(++done, static_cast<std::int64_t>(set.participants.size()))) {
      throw study::Interrupted();
    }
  }
  file.close();
  return left_out;
}

}  // namespace stillhand::experiment
