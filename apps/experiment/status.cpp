// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/status.hpp"

#include <fmt/format.h>

#include <set>

#include "apps/libraries/experiment/file/standing.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::experiment {
namespace {

std::string state_of(const Progress& progress) {
  if (!progress.excluded().empty()) return "excluded: " + progress.excluded();
  if (progress.complete()) return "complete";
  if (progress.sessions() == 0) return "not begun";
  return progress.session_open() ? "in a session, or the program stopped in it" : "to be resumed";
}

std::string row_of(const std::string& code, const Progress& progress, const Plan& plan) {
  return fmt::format("{:<12} {:>8} {:>8} {:>9} {:>8}   {}\n", code, progress.sessions(),
                     progress.practice_trials(),
                     fmt::format("{}/{}", progress.trials_done(), trials_of(plan)),
                     progress.repeats(), state_of(progress));
}

}  // namespace

Overview overview_of(const Folder& folder) {
  Overview overview;
  overview.table =
      fmt::format("{}\nexperiment.yaml: SHA-256 {}\nconditions: {}\n", folder.design().title,
                  folder.digest(), folder.unblinded() ? "unblinded" : "blinded");
  const auto planned = static_cast<std::size_t>(folder.design().participants);
  for (const Entry& entry : read_journal(folder.path() / "journal.jsonl")) {
    overview.table += in_words(entry, planned) + "\n";
  }
  overview.table += "\n";
  overview.table += fmt::format("{:<12} {:>8} {:>8} {:>9} {:>8}   {}\n", "participant", "sessions",
                                "practice", "trials", "repeats", "state");
  const std::vector<std::size_t> begun = folder.participants();
  std::set<std::size_t> all(begun.begin(), begun.end());
  for (std::size_t index = 0; index < planned; ++index) all.insert(index);
  for (const std::size_t index : all) {
    const std::vector<Entry> entries = read_journal(folder.journal(index));
    const Plan plan = folder.plan(index);
    Progress progress(folder.design(), plan);
    try {
      for (const Entry& entry : entries) progress.take(entry);
    } catch (const ConfigError& error) {
      overview.findings.push_back(folder.journal(index).string() + ": " + error.what());
      continue;
    }
    overview.table += row_of(participant_code(index), progress, plan);
    for (std::string& finding : folder.findings(index, entries)) {
      overview.findings.push_back(std::move(finding));
    }
  }
  if (const std::string finding = folder.opening_finding(); !finding.empty()) {
    overview.findings.push_back(finding);
  }
  return overview;
}

}  // namespace stillhand::experiment
