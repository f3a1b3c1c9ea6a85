// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/conduct.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <optional>

#include "apps/experiment/session_script.hpp"
#include "apps/lab/check_options.hpp"
#include "apps/lab/lab.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::experiment {
namespace {

Progress progress_of(const Folder& folder, const Plan& plan, const std::vector<Entry>& entries,
                     const std::string& origin) {
  Progress progress(folder.design(), plan);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    try {
      progress.take(entries[i]);
    } catch (const ConfigError& error) {
      throw ConfigError(fmt::format("{}:{}", origin, i + 1), error.what(), "a journal as written");
    }
  }
  return progress;
}

void set_session(const Folder& folder, std::size_t index, std::int64_t session,
                 lab::LabOptions& lab) {
  const Design& design = folder.design();
  lab.rig = kRig;
  lab.out = folder.session(index, session);
  lab.protocol.trial_s = design.trial_s;
  lab.protocol.identify_s = design.identify_s;
  lab.protocol.seed = session_seed(design, index, session);
  lab.who = design.who == "simulated" ? lab::Operator::kSimulated : lab::Operator::kMouse;
  if (lab.who == lab::Operator::kSimulated) {
    lab.subject = static_cast<std::int64_t>(index) + 1;
    lab.subject_seed = static_cast<std::uint64_t>(design.subject_seed);
  }
  lab.experiment = {participant_code(index), folder.digest(), fmt::format("{:02}", session)};
}

void check_gamepad(const Design& design, const lab::LabOptions& lab) {
  if ((design.who == "gamepad") != lab.gamepad.empty()) return;
  throw ConfigError("--gamepad", lab.gamepad.empty() ? "nothing" : lab.gamepad.string(),
                    "a device where experiment.yaml has operator: gamepad, and none elsewhere");
}

// A participant who can't go on is refused before anything is written.
void refuse_if_over(const Progress& progress, std::size_t index) {
  const std::string code = participant_code(index);
  if (!progress.excluded().empty()) {
    throw ConfigError("--participant", code + ", excluded: " + progress.excluded(),
                      "another participant");
  }
  if (progress.complete()) {
    throw ConfigError("--participant", code + ", whose protocol is complete",
                      "another participant");
  }
}

}  // namespace

std::optional<std::size_t> next_participant(const Folder& folder) {
  for (std::int64_t n = 0; n < folder.design().participants; ++n) {
    const auto index = static_cast<std::size_t>(n);
    const std::filesystem::path file = folder.journal(index);
    const Plan plan = folder.plan(index);
    const Progress progress = progress_of(folder, plan, read_journal(file), file.string());
    if (!progress.complete() && progress.excluded().empty()) return index;
  }
  return std::nullopt;
}

int conduct(const Folder& folder, std::size_t index, lab::LabOptions lab, runtime::Stop& stop) {
  check_gamepad(folder.design(), lab);
  if (folder.design().control_model == kDiagnosed) report::require_gnuplot();  // a diagnosis draws
  folder.open_participant(index);
  Journal journal(folder.journal(index));
  const Plan plan = folder.plan(index);
  Progress progress = progress_of(folder, plan, journal.entries(), folder.journal(index).string());
  refuse_if_over(progress, index);
  for (const std::string& finding : folder.findings(index, journal.entries())) {
    throw ConfigError(participant_code(index), finding, "the folder as the sessions left it");
  }
  const auto add = [&](Entry entry) { progress.take(journal.append(std::move(entry))); };
  if (progress.session_open()) {
    add({.kind = EntryKind::kSessionEnded,
         .session = progress.sessions(),
         .text = "no end in the journal: the program or the machine stopped"});
  }
  const std::int64_t session = progress.sessions() + 1;
  set_session(folder, index, session, lab);
  add({.kind = EntryKind::kSessionBegan, .session = session, .digest = folder.digest()});
  std::optional<SessionScript> script;
  try {
    script.emplace(folder, index, journal, progress, lab);
    lab.trials = script->possible_trials();
    lab::run_session(lab, stop, [&](lab::LiveTrials& trials) { script->run(trials); });
  } catch (const std::exception& error) {
    add({.kind = EntryKind::kSessionEnded,
         .session = session,
         .completed = progress.complete(),
         .text = error.what()});
    throw;
  }
  const bool complete = progress.complete();
  const std::string why = complete ? "" : script->ended().empty() ? "interrupted" : script->ended();
  add({.kind = EntryKind::kSessionEnded, .session = session, .completed = complete, .text = why});
  std::printf("%s: session %02lld, %lld of %lld trials\n", participant_code(index).c_str(),
              static_cast<long long>(session), static_cast<long long>(progress.trials_done()),
              static_cast<long long>(trials_of(plan)));
  if (complete) return 0;
  runtime::remark(why + "; run it again to go on");
  return 1;
}

int conduct_planned(const Folder& folder, std::size_t index, const std::filesystem::path& plan,
                    lab::LabOptions lab, runtime::Stop& stop) {
  check_gamepad(folder.design(), lab);
  static_cast<void>(folder.with_session(participant_code(index)));
  Journal journal(folder.journal(index));
  const Progress progress =
      progress_of(folder, folder.plan(index), journal.entries(), folder.journal(index).string());
  if (!progress.excluded().empty()) refuse_if_over(progress, index);
  // The person and the seed are those of the last session.
  set_session(folder, index, progress.sessions(), lab);
  lab::take_plan(plan, lab);
  lab.out = folder.next_planned(index);
  static_cast<void>(lab::check_options(lab));  // the journal has what began
  const std::string name = "planned " + lab.out.filename().string();
  lab.experiment.session = name;
  journal.append({.kind = EntryKind::kNote,
                  .session = progress.sessions(),
                  .text = fmt::format("{} begins: {}", name, plan.string())});
  return lab::run_lab(lab, stop);
}

}  // namespace stillhand::experiment
