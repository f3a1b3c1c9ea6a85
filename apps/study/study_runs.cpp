// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/study/recorded/find_sessions.hpp"
#include "apps/study/recorded_subjects.hpp"
#include "apps/study/subjects/study.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "services/files/settings/yaml_text.hpp"
#include "services/system/process/remark.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::study {
namespace {

namespace fs = std::filesystem;

void seal(StudyRecord& record) {
  if (record.options.undeclared_effect == 0) return;
  record.sealed = rig::sealed_text(sealed_effect(record.options).open(), digest::new_nonce());
  fmt::print("undeclared effect sealed, sha256 {}\n", digest::sha256(record.sealed));
}

// Runs `work(on_progress)` with a progress line and adds its time.
void timed(StudyRecord& record, runtime::Stop& stop, const char* what, const auto& work) {
  report::ProgressLine progress;
  const auto start = std::chrono::steady_clock::now();
  work([&](std::int64_t done, std::int64_t all) {
    progress.show(what, static_cast<double>(done) / static_cast<double>(all));
    return !stop.requested();
  });
  progress.finish();
  record.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// What an experiment registered, and the plan of the next study.
void analyse_registered(StudyRecord& record) {
  const auto pairs = planned_pairs(record);
  if (record.recorded->registered) {
    Registered& registered = *record.recorded->registered;
    registered.planned = planned_comparisons(record.analysis, pairs);
    registered.analysis_without = analyse(registered.without.results);
    registered.planned_without = planned_comparisons(registered.analysis_without, pairs);
  }
  if (record.plan_dz) {
    record.needed = participants_needed(record.analysis, pairs, *record.plan_dz, alpha_of(record));
  }
}

// Tables, figures and report of all subjects.
void conclude(StudyRecord& record, report::StagedFolder& folder, const runtime::Stop& stop,
              const fs::path& out) {
  record.analysis = analyse(record.results);
  if (record.recorded) analyse_registered(record);
  if (record.simulated && record.simulated->same_people) {
    record.simulated->paired =
        paired_checks(record.recorded->participants, record.analysis,
                      record.simulated->participants, record.simulated->analysis);
  }
  if (stop.requested()) throw Interrupted();
  write_study(record, folder);
  print_study(record);
  if (record.options.subjects <= 2) {
    runtime::remark(
        fmt::format("a t-test over {} participant(s) says nothing; 3 participants or more do, and "
                    "the paper has 12",
                    record.options.subjects));
  }
  report::say_report(out);
}

bool has_simulated_people(const StudyRecord& record) {
  const auto& registered = record.recorded->registered;
  return registered && registered->registration.design.who == "simulated";
}

// The same people, where an experiment's are simulated; otherwise as many of the population.
SimulatedSide simulated_next_to(const StudyRecord& record, const OnProgress& on_progress) {
  if (has_simulated_people(record)) {
    if (settings::yaml_text(record.options.population) !=
        settings::yaml_text(population::Population{})) {
      throw ConfigError("--population", "another population than the default",
                        "none: an experiment draws its participants from the default one");
    }
    return simulate_people(*record.recorded, record.options.threads, on_progress);
  }
  StudyOptions options = record.options;
  options.protocol.conditions.clear();
  for (const Condition condition : kPaperConditions) {
    if (record.results.front().trials.contains(condition)) {
      options.protocol.conditions.push_back(condition);
    }
  }
  return simulate_population(options, on_progress);
}

// Results must not replace the recordings that they are made of.
void check_place(const std::vector<fs::path>& recordings, const fs::path& out) {
  for (const fs::path& folder : recordings) {
    std::error_code missing;
    if (fs::equivalent(folder, out, missing)) {
      throw ConfigError("--out", out.string() + ", the folder of a recording", "another folder");
    }
  }
}

}  // namespace

int run_whole(StudyRecord& record, const fs::path& out) {
  runtime::Stop stop;
  report::StagedFolder folder(out);
  report::require_gnuplot();
  seal(record);
  timed(record, stop, "subjects", [&](const OnProgress& on_progress) {
    record.results = run_study(record.options, on_progress);
  });
  conclude(record, folder, stop, out);
  return 0;
}

int run_recorded(StudyRecord& record, const std::vector<fs::path>& folders, const fs::path& out) {
  const std::vector<SessionFile> files = find_sessions(folders);
  const auto registration = registration_of(folders, files.front().digest);
  std::vector<fs::path> inputs = folders;
  for (const SessionFile& file : files) inputs.push_back(file.path.parent_path());
  check_place(inputs, out);
  runtime::Stop stop;
  report::StagedFolder folder(out);
  report::require_gnuplot();
  timed(record, stop, "sessions", [&](const OnProgress& on_progress) {
    read_recorded(files, registration, record, on_progress);
  });
  if (record.simulate) {
    timed(record, stop, "simulated people", [&](const OnProgress& on_progress) {
      record.simulated = simulated_next_to(record, on_progress);
    });
  }
  if (record.diagnose) {
    timed(record, stop, "diagnoses", [&](const OnProgress& on_progress) {
      record.diagnoses =
          diagnose_people(files, *record.recorded, record.options.threads, on_progress);
    });
  }
  conclude(record, folder, stop, out);
  return 0;
}

}  // namespace stillhand::study
