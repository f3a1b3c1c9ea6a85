// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/lateness.hpp"

#include <fmt/format.h>

#include "apps/libraries/measurement/session_trials.hpp"
#include "apps/libraries/measurement/tables/bag_table.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "apps/libraries/session/answer_settings.hpp"
#include "apps/libraries/session/force_budget_json.hpp"
#include "apps/libraries/session/force_budget_table.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::diagnose {
namespace {

using report::number;

std::vector<measurement::SessionTrial> cancelled_trials(const std::string& path,
                                                        const std::string& wanted) {
  recording::FileSource file(path);
  recording::McapReader reader(file);
  const measurement::SessionTrials found = measurement::find_trials(reader, path);
  std::vector<measurement::SessionTrial> trials;
  if (wanted.empty()) {
    trials = found.trials;
  } else {
    trials.push_back(measurement::choose(found, wanted, path));
  }
  std::erase_if(trials, [](const auto& trial) {
    return trial.blinded || trial.letter != 'C' || !trial.named.empty() ||
           trial.trial.phase != TrialPhase::kTracking;
  });
  return trials;
}

}  // namespace

std::vector<RecordedSplit> recorded_splits(const std::vector<std::string>& recordings,
                                           const std::string& trial,
                                           const std::filesystem::path& config) {
  std::vector<RecordedSplit> splits;
  for (const std::string& path : recordings) {
    if (measurement::kind_of(path) != measurement::FileKind::kMcap ||
        !measurement::is_session(path)) {
      continue;
    }
    const auto trials = cancelled_trials(path, trial);
    if (trials.empty()) continue;
    const session::SessionRecording recorded = session::read_session(path);
    const session::AnswerConfigs answers = session::load_answers(config);
    for (const measurement::SessionTrial& each : trials) {
      Trial measured = each.trial;
      measured.duration_ticks = each.end_tick - measured.start_tick;
      splits.push_back(
          {path, measured.number, each.name(), session::split_trial(recorded, measured, answers)});
    }
  }
  return splits;
}

std::string splits_table(const std::vector<RecordedSplit>& splits) {
  std::string text;
  for (const RecordedSplit& each : splits) {
    const auto& budget = each.split.budget;
    if (!budget) {
      text += fmt::format("lateness      trial {} is not split: {}\n", each.trial, each.split.why);
      continue;
    }
    text += fmt::format(
        "lateness      trial {} leaves {:.2f} N RMS of the feedthrough force; by cause (95 %):\n",
        each.trial, budget->left.force_n);
    for (const session::ForceCause& cause : session::kForceCauses) {
      const session::ForceEstimate& part = (*budget).*cause.of;
      text += fmt::format("{:14}{:<12} {:>5} N ({} to {}): {}\n", "", cause.key,
                          number(part.force_n, 2), number(part.low_n, 2), number(part.high_n, 2),
                          cause.meaning);
    }
  }
  return text;
}

std::string with_splits(const std::string& json, const std::vector<RecordedSplit>& splits) {
  auto verdict = nlohmann::ordered_json::parse(json);
  auto& list = verdict["lateness"] = nlohmann::ordered_json::array();
  for (const RecordedSplit& each : splits) {
    nlohmann::ordered_json entry{{"recording", each.recording}, {"trial", each.number}};
    if (each.split.budget) {
      entry.update(session::budget_json(each.split.budget));
    } else {
      entry["why_not"] = each.split.why;
    }
    list.push_back(std::move(entry));
  }
  return verdict.dump(2) + "\n";
}

void add_splits(const std::vector<RecordedSplit>& splits, report::Page& page) {
  if (splits.empty()) return;
  page.section("Lateness, before the model");
  for (const RecordedSplit& each : splits) {
    if (each.split.budget) {
      page.table(session::budget_table("trial " + each.trial, *each.split.budget));
    } else {
      page.paragraph("Trial " + each.trial + " is not split: " + each.split.why + ".");
    }
  }
}

}  // namespace stillhand::diagnose
