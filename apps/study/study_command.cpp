// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "apps/study/explain/calibrate.hpp"
#include "apps/study/explain/explanation_output.hpp"
#include "apps/study/mitigations/campaign_command.hpp"
#include "apps/study/plan_options.hpp"
#include "apps/study/study_runs.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::study {
namespace {

// Options that are no field of StudyOptions.
struct Arguments {
  std::string conditions = "A,B,C";
  std::filesystem::path population;
  std::filesystem::path out;
  std::vector<std::filesystem::path> sessions;
  std::string explain_paper;
  bool calibrate = false;
  CampaignArguments campaign;
};

// Without --subjects: enough for the spread between subjects.
constexpr std::int64_t kExplainSubjects = 32;

// Values of --explain-paper.
constexpr const char* kAll = "all";
constexpr const char* kMeans = "means";
constexpr const char* kSpread = "spread";

ExplainOptions explain_options(const StudyRecord& record, bool subjects_given) {
  ExplainOptions options;
  options.study = record.options;
  options.seed = record.options.seed;
  options.threads = record.options.threads;
  options.subjects =
      static_cast<std::size_t>(subjects_given ? record.options.subjects : kExplainSubjects);
  return options;
}

// Runs explain_paper() or calibrate() with progress.
auto with_progress(const auto& work, const ExplainOptions& options) {
  runtime::Stop stop;
  report::ProgressLine progress;
  auto result = work(options, [&](const std::string& stage, double share) {
    progress.show(stage, share);
    return !stop.requested();
  });
  progress.finish();
  return result;
}

int run_calibration(const StudyRecord& record, const Arguments& arguments, bool subjects_given) {
  std::vector<std::filesystem::path> inputs;
  if (!arguments.population.empty()) inputs.push_back(arguments.population);
  report::ResultFiles files({{"--out", arguments.out}}, inputs);
  const Calibration calibration = with_progress(calibrate, explain_options(record, subjects_given));
  files.set("--out", population_yaml(calibration, record.command_line));
  files.publish();
  print_calibration(calibration);
  fmt::print("population in {}\n", arguments.out.string());
  return 0;
}

int explain(const StudyRecord& record, const Arguments& arguments, bool subjects_given) {
  report::StagedFolder folder(arguments.out);
  ExplainOptions options = explain_options(record, subjects_given);
  options.means = arguments.explain_paper != kSpread;
  options.spread = arguments.explain_paper != kMeans;
  const Explanation explanation = with_progress(explain_paper, options);
  write_explanation(explanation, record.command_line, folder);
  report::say_report(arguments.out);
  return 0;
}

// Conditions, lengths and seed.
void add_protocol_options(command_line::Command& study, StudyOptions& options,
                          Arguments& arguments) {
  study.add_option("--seed", options.seed, "seed of everything random").check(session::check_seed);
  study.add_option("--conditions", arguments.conditions,
                   "comma-separated: " + session::known_conditions(session::kStudyConditions));
  study
      .add_option("--canceller", options.canceller,
                  "canceller of condition C: now (1 kHz), or paper (50 Hz, after the paper's "
                  "low-pass of 10 Hz, one sample late)")
      .one_of({"now", "paper"});
  study.add_flag("--wrong-models", options.wrong_models,
                 "run C again with another subject's model and with the mean model of all others");
  study.add_option("--trial-seconds", options.protocol.trial_s, "length of a tracking trial [s]");
  study.add_option("--identify-seconds", options.protocol.identify_s,
                   "length of the pegged trial [s]");
}

// Subjects and their rigs.
void add_subject_options(command_line::Command& study, StudyOptions& options,
                         Arguments& arguments) {
  study.add_option("--subjects", options.subjects, "number of subjects; the paper has 12");
  study
      .add_option("--population", arguments.population,
                  "file with the population's distributions; deploy/experiments/population.yaml "
                  "shows every key")
      .check(settings::check_name);
  study
      .add_option("--stick-damping", options.damped_stick_n_s_m,
                  "condition E: damping added to the stick [N s/m]")
      .check(settings::number_between(0.0, 49.0));
  study
      .add_option("--motor-delay", options.motor.delay_s,
                  "motor.delay_s of every rig [s]: delay from a command to the motor's current")
      .check(settings::number_between(0.0, 0.2));
  study
      .add_option(
          "--answer-wait", options.motor.answer_wait_s,
          "motor.answer_wait_s of every rig [s]; 0: a motor command is used at the beginning "
          "of the next tick")
      .check(settings::number_between(0.0, 0.0007));
  study
      .add_option("--undeclared-effect", options.undeclared_effect,
                  "seed of an effect that only the rigs hold, revealed with the results; 0: none")
      .check(session::check_seed);
}

// The study of recorded people.
void add_sessions_option(command_line::Command& study, Arguments& arguments) {
  command_line::Option sessions =
      study.add_option("--sessions", arguments.sessions,
                       "folders of recorded sessions or of experiments: study "
                       "the people in them, from session.mcap alone");
  for (const std::string& name : study.option_names()) {
    constexpr std::array kWithSessions{"--out", "--sessions", "--threads", "--population",
                                       "--help"};
    if (std::ranges::find(kWithSessions, name) == kWithSessions.end()) sessions.excludes(name);
  }
}

}  // namespace

void add_study_command(command_line::Command& cli, int& status) {
  auto record = std::make_shared<StudyRecord>();
  auto arguments = std::make_shared<Arguments>();
  record->options.protocol.identify_s = 120.0;  // paper III-A
  command_line::Command study = cli.add_subcommand(
      "study",
      "Runs the paper's experiment with simulated subjects, in one process and as fast as it can,\n"
      "or evaluates recorded people (--sessions).\n"
      "Each subject has a pegged identification and one trial for each condition. Tables and\n"
      "figures stand next to the paper's.\n"
      "Example: stillhand study --subjects 12 --seed 1 --out study1");
  study.add_option("--out", arguments->out, "folder for report, figures and numbers").required();
  add_protocol_options(study, record->options, *arguments);
  add_subject_options(study, record->options, *arguments);
  study
      .add_option("--threads", record->options.threads,
                  "number of threads, 0: one per core; the results do not depend on it")
      .between(0, 256);
  command_line::Option explaining =
      study
          .add_option(
              "--explain-paper", arguments->explain_paper,
              "instead of a study: look for causes of the paper's means in C (means), of the "
              "spread between its people (spread), or of both (all, or nothing)")
          .expected(0, 1)
          .default_str(kAll)
          .one_of({kAll, kMeans, kSpread})
          .excludes("--population");
  command_line::Option calibrating =
      study
          .add_flag(
              "--calibrate", arguments->calibrate,
              "instead of a study: calibrate the population to A and B of the paper's Table I, "
              "and write it to the file --out")
          .excludes(explaining);
  command_line::Option mitigations =
      study.add_option("--mitigations", arguments->campaign.mitigations,
                       "instead of a study: the table of mitigations, each in every task and "
                       "motion, with the own, the average and another subject's model; 48 subjects "
                       "and trials of 60 s by default. comma-separated: " +
                           session::known_conditions(session::kMitigations));
  for (const char* name : {"--conditions", "--canceller", "--wrong-models", "--motor-delay",
                           "--answer-wait", "--undeclared-effect"}) {
    for (command_line::Option instead : {explaining, calibrating, mitigations}) {
      instead.excludes(name);
    }
  }
  mitigations.excludes("--stick-damping").excludes(explaining).excludes(calibrating);
  add_sessions_option(study, *arguments);
  add_plan_options(study, record->plan_dz);
  add_people_options(study, *record);
  for (const char* name : {"--plan", "--plan-effect", "--diagnose", "--simulated"}) {
    study.get_option(name).needs("--sessions");
  }
  study.group("Simulated subjects and rig",
              {"--population", "--stick-damping", "--motor-delay", "--answer-wait", "--canceller",
               "--wrong-models", "--undeclared-effect"});
  study.group("Recorded people",
              {"--sessions", "--plan", "--plan-effect", "--diagnose", "--simulated"});
  study.group("Research", {"--explain-paper", "--calibrate", "--mitigations"});
  study.callback([record, arguments, &status, study] {
    record->options.protocol.conditions =
        session::parse_conditions(arguments->conditions, session::kStudyConditions);
    // The set of conditions defines the study, not the order in which they are named.
    std::sort(record->options.protocol.conditions.begin(),
              record->options.protocol.conditions.end());
    if (!arguments->population.empty()) {
      record->options.population =
          settings::load<population::Population>(arguments->population, "population");
    }
    record->command_line = report::command_line();
    if (!arguments->sessions.empty() && !arguments->population.empty() && !record->simulate) {
      throw ConfigError("--population", arguments->population.string(),
                        "--simulated with it: recorded people have no population");
    }
    if (study.count("--mitigations") > 0 && arguments->campaign.mitigations.empty()) {
      throw ConfigError("--mitigations", "nothing", "all, or names with commas");
    }
    const bool subjects_given = study.count("--subjects") > 0;
    arguments->campaign.subjects_given = subjects_given;
    arguments->campaign.trial_given = study.count("--trial-seconds") > 0;
    status = !arguments->campaign.mitigations.empty()
                 ? run_campaign_command(*record, arguments->campaign, arguments->out)
             : study.count("--explain-paper") > 0 ? explain(*record, *arguments, subjects_given)
             : arguments->calibrate ? run_calibration(*record, *arguments, subjects_given)
             : !arguments->sessions.empty()
                 ? run_recorded(*record, arguments->sessions, arguments->out)
                 : run_whole(*record, arguments->out);
  });
}

}  // namespace stillhand::study
