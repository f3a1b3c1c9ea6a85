// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/diagnose_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/diagnose/broken_tie.hpp"
#include "apps/diagnose/diagnose_options.hpp"
#include "apps/diagnose/diagnosis_json.hpp"
#include "apps/diagnose/page/diagnosis_report.hpp"
#include "apps/diagnose/page/lateness.hpp"
#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/verdict_stability.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/core/next_run/tie.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/run_jobs.hpp"
#include "services/system/process/shipped.hpp"
#include "services/system/process/stop.hpp"
#include "version.hpp"

namespace stillhand::diagnose {
namespace {

struct Arguments {
  std::vector<std::string> recordings;
  measurement::ReadOptions read;
  diagnosis::DiagnoseOptions options;
  std::filesystem::path save;
  std::filesystem::path json;
  std::filesystem::path report;
  std::filesystem::path plan;
  std::filesystem::path config = runtime::shipped("deploy/config");
  int stability = 0;
};

// A recording that is given twice would be held out and fitted to at the same time.
void check_different(const std::vector<std::string>& recordings) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code error;
      if (std::filesystem::equivalent(recordings[i], recordings[j], error)) {
        throw ConfigError("REC", recordings[i] + " and " + recordings[j] + ", the same file",
                          "each recording once");
      }
    }
  }
}

// The candidates were fitted to certain recordings, and the evidence counts for no others.
void check_plan_is_of(const std::filesystem::path& plan, const std::vector<std::string>& before) {
  const auto provenance = report::provenance_in(recording::read_file(plan.string()));
  const auto digests_of = [](const std::vector<report::SourceFile>& files) {
    std::vector<std::string> digests;
    for (const report::SourceFile& file : files) digests.push_back(file.sha256);
    std::ranges::sort(digests);
    return digests;
  };
  const auto given = report::provenance_of_this_call({before.begin(), before.end()});
  if (!provenance || digests_of(provenance->sources) != digests_of(given.sources)) {
    throw ConfigError("--plan", plan.string() + ", a plan of other recordings",
                      "the recordings that it was made from, unchanged, before its run");
  }
}

// Before the recordings are read.
std::optional<next_run::PlanFile> plan_of(const Arguments& arguments) {
  if (arguments.plan.empty()) return std::nullopt;
  if (arguments.recordings.size() < 2) {
    throw ConfigError("--plan", "one recording with it",
                      "the recordings that left the tie, and then the run of the plan");
  }
  check_plan_is_of(arguments.plan, {arguments.recordings.begin(), arguments.recordings.end() - 1});
  return next_run::read_plan(arguments.plan, kVersion);
}

// The last recording is the run of the plan.
std::optional<BrokenTie> tie_of(const std::optional<next_run::PlanFile>& plan,
                                std::vector<diagnosis::Measurement> parts) {
  if (!plan) return std::nullopt;
  const diagnosis::Measurement run = std::move(parts.back());
  parts.pop_back();
  return broken_tie(*plan, measurement::join(std::move(parts)), run);
}

// The tied kinds of each effect are those that the whole recording leaves, as `plan-run` judges
// them; the search alone is more lenient (DG-17).
std::vector<next_run::Tie> judge_ties(const diagnosis::Measurement& measurement,
                                      diagnosis::Diagnosis& result) try {
  if (result.no_model) return {};
  const std::vector<std::string>& inputs = result.options.inputs;
  const diagnosis::Signals signals(diagnosis::working_set(measurement, inputs), inputs,
                                   result.options.output);
  std::vector<next_run::Tie> ties = next_run::ties_of(result, signals);
  for (diagnosis::FoundEffect& effect : result.effects) effect.ties.clear();
  for (const next_run::Tie& tie : ties) {
    diagnosis::FoundEffect& effect = result.effects[tie.effect];
    for (const next_run::Candidate& each : tie.left) {
      if (each.cause().kind != effect.effect.kind) effect.ties.push_back(each.cause().kind);
    }
    effect.evidence += "; " + tie.in_words();
  }
  return ties;
} catch (const ConfigError& error) {  // a rival whose run is not finite takes no verdict away
  result.notes.push_back(std::string("what ties is the search's word alone: ") + error.what());
  return {};
}

// Of one input; a mass is no sum of several.
void note_unchecked(const diagnosis::Measurement& measurement, diagnosis::Diagnosis& result) {
  const std::vector<std::string>& inputs = result.options.inputs;
  const std::string why =
      inputs.size() > 1
          ? "units not checked, because only one motion in m/s^2 and a force in N have a hand's "
            "mass, and these are several inputs"
          : diagnosis::why_unchecked({inputs.front(), measurement.find(inputs.front())->unit, 0.0,
                                      result.options.output, result.output_unit, 0.0});
  if (!why.empty()) result.notes.push_back(why);
}

int run(const Arguments& arguments) {
  runtime::Stop stop;
  check_different(arguments.recordings);
  report::ResultFiles files({{"--save", arguments.save}, {"--json", arguments.json}},
                            {arguments.recordings.begin(), arguments.recordings.end()});
  const std::optional<next_run::PlanFile> plan = plan_of(arguments);
  std::optional<report::StagedFolder> folder;
  if (!arguments.report.empty()) {
    report::require_gnuplot();
    folder.emplace(arguments.report, "--report");
  }
  const runtime::EndAfterStop end(stop, [&] {
    if (folder) folder->clear_away();
  });
  std::vector<diagnosis::Measurement> parts =
      read_recordings(arguments.recordings, arguments.read, arguments.options);
  const std::optional<BrokenTie> tie = tie_of(plan, parts);
  const diagnosis::Measurement measurement = measurement::join(std::move(parts));
  const std::vector<RecordedSplit> splits =
      recorded_splits(arguments.recordings, arguments.read.trial, arguments.config);
  report::ProgressLine progress;
  diagnosis::DiagnoseOptions options = arguments.options;
  options.for_each = runtime::on_all_cores;
  double done = 0.0;
  options.progress = [&](const std::string& step) {
    progress.show(step, done);
    done += 0.5 * (1.0 - done);  // the number of effects is not known in advance
    return !stop.requested();
  };
  diagnosis::Diagnosis result = diagnosis::diagnose(measurement, options);
  if (arguments.stability > 0) {
    result.stability = diagnosis::verdict_stability(measurement, options, arguments.stability);
  }
  const std::vector<next_run::Tie> ties = judge_ties(measurement, result);
  progress.finish();
  note_unchecked(measurement, result);
  // The sentence that the verdict is has been a note of the samples.
  if (result.no_model) std::erase(result.notes, result.no_model->why);
  if (result.no_model && files.wants("--save")) {
    throw ConfigError("--save", "no model (" + result.no_model->why + ")",
                      "no --save, or recordings whose inputs explain the output");
  }
  if (files.wants("--save")) {
    files.set_json("--save",
                   diagnosis::model_json(result.model, result.carried, result.baseline.model));
  }
  if (files.wants("--json")) {
    const std::string json = with_splits(diagnosis_json(result), splits);
    files.set_json("--json", tie ? with_tie(json, *tie) : json);
  }
  if (folder) write_report(result, measurement, arguments.recordings, *folder, splits);
  files.publish();
  std::fputs(splits_table(splits).c_str(), stdout);
  std::fputs(diagnosis_table(result).c_str(), stdout);
  if (tie) std::fputs(tie_table(*tie).c_str(), stdout);
  folder ? report::say_report(arguments.report)
         : report::say_next("the same command with --report DIR draws what was found");
  if (result.no_model) {
    report::say_next(measurement::step_for(result.no_model->reason));
    return 0;
  }
  if (arguments.plan.empty() && !std::ranges::all_of(ties, &next_run::Tie::broken)) {
    report::say_next("stillhand plan-run finds the motion that settles the tie");
  }
  report::say_next(arguments.save.empty()
                       ? "--save MODEL keeps the model, for `stillhand predict`"
                       : fmt::format("stillhand predict {} ANOTHER_RECORDING{} --out predicted.csv",
                                     report::quoted_for_shell(arguments.save.string()),
                                     measurement::words_of(arguments.read)));
  return 0;
}

}  // namespace

void add_diagnose_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  command_line::Command verb = cli.add_subcommand(
      "diagnose",
      "Finds what the model lacks. Fits a linear model to the recording, takes the residual of "
      "its\nfree run (its prediction from the inputs alone) on samples that the fit has not seen, "
      "traces\nit to an effect, adds the effect, and prints the error before and after. The kinds "
      "of effect:\nservices/core/diagnosis/README.md.\nREC: the MCAP file of a session, or a CSV, "
      "MATLAB, HDF5, ROS 2 (MCAP) or sound file with\ncolumns 'name [unit]' and 't [s]'. For other "
      "columns, use --map. Several "
      "recordings of one rig\nare diagnosed together.\nExample: stillhand diagnose ride.csv "
      "--input a_y --output f --json out.json --report DIR");
  add_recordings(verb, arguments->recordings, arguments->read, arguments->options);
  verb.add_option("--stability", arguments->stability,
                  "repeat the diagnosis this many times, a fifth of the recording left out at "
                  "random, and count the verdicts [0: no repetition]")
      .default_str("")
      .between(0, 1000);
  verb.add_option("--plan", arguments->plan,
                  "plan.json of `stillhand plan-run`: the last REC is its run, and the verb says "
                  "which of the tied causes is left")
      .check(settings::check_name);
  verb.add_flag("--lateness", arguments->read.lateness,
                "take the channels of lateness of a session (age of the answers, lost ticks, ...) "
                "for candidates too");
  verb.add_option("--config", arguments->config,
                  "folder of the settings that a session ran with, to split what its motor left "
                  "into causes")
      .check(settings::check_name);
  verb.add_option("--save", arguments->save,
                  "file for the diagnosed model, for `stillhand predict`")
      .check(settings::check_name);
  verb.add_option("--json", arguments->json, "file for the verdict; - is standard output")
      .check(settings::check_name);
  verb.add_option("--report", arguments->report, "folder for a page with figures")
      .check(settings::check_name);
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::diagnose
