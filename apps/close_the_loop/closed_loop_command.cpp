// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/closed_loop_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/close_the_loop/live_session.hpp"
#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/recorded/recorded_command.hpp"
#include "apps/close_the_loop/repeats.hpp"
#include "apps/diagnose/diagnose_options.hpp"
#include "apps/lab/lab.hpp"
#include "apps/lab/undeclared_effect.hpp"
#include "apps/report/command_line.hpp"
#include "apps/report/plot/draw.hpp"
#include "apps/report/progress.hpp"
#include "apps/report/staged_folder.hpp"
#include "services/cancellation/control_model_file.hpp"
#include "services/contract/config_error.hpp"
#include "services/diagnosis/model_file.hpp"
#include "services/population/population.hpp"
#include "services/recording/file_io.hpp"
#include "services/rig/sealed_file.hpp"
#include "services/runtime/process/real_time.hpp"
#include "services/runtime/process/run_jobs.hpp"
#include "services/runtime/process/stop.hpp"

namespace stillhand::close_the_loop {
namespace {

struct Words {
  lab::LabOptions lab;  ///< protocol, folder, effect; the rest with --live
  bool live = false;
  bool off_catalogue = false;
  std::int64_t repeats = 10;
  unsigned threads = 0;      ///< 0: one per core
  RecordedOptions recorded;  ///< with --pegged, in place of a session
};

// Steps of one pass through the loop, and the loop's part of the progress line.
constexpr double kUsualSteps = 15.0;
constexpr double kLoopShare = 0.6;

unsigned threads_of(const Words& words) {
  return words.threads > 0 ? words.threads : runtime::core_count();
}

DeclaredDrive declared_drive(const rig::RigConfig& rig) {
  return {rig.stick, kControlPeriod_s + rig.motor.lag_s};
}

session::CoreConfigs configs_of(const Words& words) {
  session::CoreConfigs configs;
  if (words.lab.subject == 0) return configs;
  const population::Subject subject =
      population::draw_subject({}, words.lab.protocol.seed, words.lab.subject - 1);
  configs.rig.body = subject.body;
  configs.human_operator = subject.who;
  return configs;
}

// What both modes need besides the session.
LoopRecord new_record(const Words& words) {
  LoopRecord record;
  record.command_line = report::command_line();
  record.undeclared_effect = words.lab.undeclared_effect;
  record.live = words.live;
  record.subject = words.lab.subject;
  record.options.protocol = words.lab.protocol;
  record.options.declared = declared_drive(session::CoreConfigs{}.rig);
  record.options.hand = average_hand();
  record.options.diagnose = words.recorded.diagnose;
  record.options.diagnose.for_each = [threads = threads_of(words)](std::size_t count,
                                                                   const auto& job) {
    runtime::run_jobs(count, threads, job);
  };
  return record;
}

void write_files(const LoopRecord& record, std::uint32_t rig, report::StagedFolder& folder) {
  folder.write("summary.json", summary_json(record));
  const diagnosis::Diagnosis& body = record.result.verdict().body;
  folder.write("model.json", diagnosis::model_json(body.model, body.carried));
  folder.write(kControlModelFile,
               cancellation::control_model_json(chosen_model(record.result, record.decision), rig));
  const auto drawings = report::render(loop_figures(record), folder.path());
  loop_page(record, drawings).write(folder.path() / "report.html");
}

void run_in_process(const Words& words) {
  runtime::Stop stop;
  // The recording of another session must not be removed.
  if (std::filesystem::exists(words.lab.out / "session.mcap")) {
    throw ConfigError("--out", words.lab.out.string() + ", which holds the recording of a session",
                      "a folder without one");
  }
  report::StagedFolder folder(words.lab.out);
  report::require_gnuplot();
  LoopRecord record = new_record(words);
  report::ProgressLine progress;
  int steps = 0;
  record.options.progress = [&](const std::string& step) {
    progress.show(step, kLoopShare * std::min(steps++ / kUsualSteps, 0.98));
    return !stop.requested();
  };
  const SimulatedRig rig{
      configs_of(words), words.lab.undeclared_effect,
      words.off_catalogue ? rig::EffectSource::kOutsideKinds : rig::EffectSource::kKinds};
  InProcessSession session(rig, words.lab.protocol.seed);
  if (record.undeclared_effect != 0) {
    std::printf("undeclared effect sealed, sha256 %.64s\n", session.commitment().c_str());
    folder.write(rig::kCommitmentFile, session.commitment());
  }
  record.result = close_loop(session, record.options);
  folder.write(kVerdictFile, verdict_json(record.result.verdict()));
  RepeatOptions repeats{words.repeats, threads_of(words), {}};
  repeats.progress = [&](double share) {
    progress.show("repeats", kLoopShare + (1.0 - kLoopShare) * share);
    return !stop.requested();
  };
  record.conditions = run_repeats(record.result, words.lab.protocol, rig, repeats);
  record.decision = decide(record.conditions, record.result);
  progress.finish();
  if (record.undeclared_effect != 0) {
    rig::open_effect(folder.path(), session.open_effect(), kVerdictFile);
    record.truth = truth_of(session.open_effect());
  }
  write_files(record, words.lab.rig, folder);
  folder.publish(every_name());
  print_result(record);
}

void run_live(const Words& words) {
  runtime::Stop stop;
  report::require_gnuplot();
  const std::filesystem::path& out = words.lab.out;
  const std::filesystem::path recording = out / "session.mcap";
  LoopRecord record = new_record(words);
  record.options.progress = [&](const std::string& /*step*/) { return !stop.requested(); };
  record.options.aside = [](const std::function<void()>& work) {
    const runtime::OrdinaryWhile ordinary;
    work();
  };
  lab::LiveSession live = lab::run_session(words.lab, stop, [&](lab::LiveTrials& trials) {
    LiveTrialSession session(trials, recording);
    record.result = close_loop(session, record.options);
  });
  if (record.result.rounds.empty()) throw diagnosis::Interrupted();
  judge_cancellation(recording, live.outcomes, record.result);
  record.conditions = own_trials(record.result);
  record.decision = decide(record.conditions, record.result);
  // The verdict is written before the truth is opened.
  if (const auto status = recording::write_file_atomically((out / kVerdictFile).string(),
                                                           verdict_json(record.result.verdict()));
      !status.ok()) {
    throw std::runtime_error(status.text);
  }
  if (!live.sealed.empty()) {
    lab::open_undeclared_effect(words.lab, live, kVerdictFile);
    record.truth = truth_of(recording::read_file((out / rig::kSealedFile).string()));
  }
  live.folder.reset();
  report::StagedFolder folder(out);
  write_files(record, words.lab.rig, folder);
  folder.publish({});
  print_result(record);
}

// Effect, subject and repeats of a run in one process.
void add_comparison_options(CLI::App& verb, const std::shared_ptr<Words>& words,
                            CLI::Option* effect, CLI::Option* live) {
  verb.add_flag("--off-catalogue", words->off_catalogue,
                "the effect is one that no kind of `stillhand diagnose` describes")
      ->needs(effect)
      ->excludes(live);
  verb.add_option("--repeats", words->repeats,
                  "trials of each condition, with other draws of target, motion and remnant; with "
                  "--live one")
      ->check(CLI::Range(1, 1000))
      ->excludes(live)
      ->capture_default_str();
  verb.add_option(
          "--subject", words->lab.subject,
          "number of the subject that `stillhand study --seed` draws; 0: the one in the settings")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  verb.add_option("--threads", words->threads,
                  "number of threads; the results do not depend on it; 0: one per core")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
}

}  // namespace

void add_closed_loop_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  lab::LabOptions& lab = words->lab;
  lab::set_places(lab);
  lab.headless = true;
  lab.subject = 1;
  lab.protocol.identify_s = 120.0;  // paper III-A
  lab.protocol.conditions = session::parse_conditions("A,B,C");
  CLI::App* verb = cli.add_subcommand(
      "close-the-loop",
      "Puts what the model lacks back into the canceller: identifies with the stick "
      "pegged, runs A, B\n"
      "and C with the paper's model, diagnoses the recordings, augments the model "
      "and runs C again (C+),\n"
      "until nothing new is found or C+ no longer improves. With --pegged it works on recordings.\n"
      "Examples: stillhand close-the-loop --undeclared-effect 7 --out loop1\n"
      "          stillhand close-the-loop --pegged day1.csv day2.csv --out loop2");
  CLI::Option* effect =
      verb->add_option(
              "--undeclared-effect", lab.undeclared_effect,
              "seed of an effect that only the rig knows, revealed after the verdict; 0: none")
          ->check(session::check_seed)
          ->capture_default_str();
  CLI::Option* seed =
      verb->add_option("--seed", lab.protocol.seed, "seed of everything else that is random")
          ->check(session::check_seed)
          ->capture_default_str();
  verb->add_option("--out", lab.out, "folder of report, figures and numbers")->required();
  CLI::Option* trial =
      verb->add_option("--trial-seconds", lab.protocol.trial_s, "length of a tracking trial [s]")
          ->capture_default_str();
  CLI::Option* identify = verb->add_option("--identify-seconds", lab.protocol.identify_s,
                                           "length of the pegged trial [s]; the paper's is 120")
                              ->capture_default_str();
  CLI::Option* live = verb->add_flag(
      "--live", words->live, "over DDS, with every process, in real time; the recording is kept");
  verb->add_option("--domain", lab.domain, "with --live: DDS domain, 0 to 232")
      ->needs(live)
      ->capture_default_str();
  verb->add_option("--rig", lab.rig, "with --live: number of the rig on the bus")
      ->needs(live)
      ->capture_default_str();
  add_comparison_options(*verb, words, effect, live);
  diagnose::add_diagnose_options(*verb, words->recorded.diagnose);
  words->recorded.declared = declared_drive(session::CoreConfigs{}.rig);
  add_recorded_options(*verb, words->recorded,
                       {effect, seed, trial, identify, live, verb->get_option("--repeats"),
                        verb->get_option("--subject")});
  verb->callback([words, &status] {
    if (!words->recorded.pegged.empty()) {
      run_recorded(words->recorded, words->lab.out, words->lab.rig, threads_of(*words));
    } else {
      words->live ? run_live(*words) : run_in_process(*words);
    }
    std::printf("report in %s\n", words->lab.out.string().c_str());
    status = 0;
  });
}

}  // namespace stillhand::close_the_loop
