// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/closed_loop_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/recorded_command.hpp"
#include "apps/close_the_loop/session/live_session.hpp"
#include "apps/close_the_loop/session/repeats.hpp"
#include "apps/diagnose/diagnose_options.hpp"
#include "apps/lab/lab.hpp"
#include "apps/lab/undeclared_effect.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/population/population.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/real_time.hpp"
#include "services/system/process/run_jobs.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::close_the_loop {
namespace {

struct Arguments {
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

unsigned threads_of(const Arguments& arguments) {
  return arguments.threads > 0 ? arguments.threads : runtime::core_count();
}

DeclaredDrive declared_drive(const rig::RigConfig& rig) {
  return {rig.stick, kControlPeriod_s + rig.motor.lag_s};
}

session::CoreConfigs configs_of(const Arguments& arguments) {
  session::CoreConfigs configs;
  if (arguments.lab.subject == 0) return configs;
  const population::Subject subject =
      population::draw_subject({}, arguments.lab.protocol.seed, arguments.lab.subject - 1);
  configs.rig.body = subject.body;
  configs.human_operator = subject.who;
  return configs;
}

// What both modes need besides the session.
LoopRecord new_record(const Arguments& arguments) {
  LoopRecord record;
  record.command_line = report::command_line();
  record.undeclared_effect = arguments.lab.undeclared_effect;
  record.live = arguments.live;
  record.subject = arguments.lab.subject;
  record.options.protocol = arguments.lab.protocol;
  record.options.declared = declared_drive(session::CoreConfigs{}.rig);
  record.options.hand = average_hand();
  record.options.diagnose = arguments.recorded.diagnose;
  record.options.diagnose.for_each = [threads = threads_of(arguments)](std::size_t count,
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

void run_in_process(const Arguments& arguments) {
  runtime::Stop stop;
  // The recording of another session must not be removed.
  if (std::filesystem::exists(arguments.lab.out / "session.mcap")) {
    throw ConfigError("--out",
                      arguments.lab.out.string() + ", which holds the recording of a session",
                      "a folder without one");
  }
  report::StagedFolder folder(arguments.lab.out);
  report::require_gnuplot();
  LoopRecord record = new_record(arguments);
  report::ProgressLine progress;
  int steps = 0;
  record.options.progress = [&](const std::string& step) {
    progress.show(step, kLoopShare * std::min(steps++ / kUsualSteps, 0.98));
    return !stop.requested();
  };
  const SimulatedRig rig{
      configs_of(arguments), arguments.lab.undeclared_effect,
      arguments.off_catalogue ? rig::EffectSource::kOutsideKinds : rig::EffectSource::kKinds};
  InProcessSession session(rig, arguments.lab.protocol.seed);
  if (record.undeclared_effect != 0) {
    std::printf("undeclared effect sealed, sha256 %.64s\n", session.commitment().c_str());
    folder.write(rig::kCommitmentFile, session.commitment());
  }
  record.result = close_loop(session, record.options);
  folder.write(kVerdictFile, verdict_json(record.result.verdict()));
  RepeatOptions repeats{arguments.repeats, threads_of(arguments), {}};
  repeats.progress = [&](double share) {
    progress.show("repeats", kLoopShare + (1.0 - kLoopShare) * share);
    return !stop.requested();
  };
  record.conditions = run_repeats(record.result, arguments.lab.protocol, rig, repeats);
  record.decision = decide(record.conditions, record.result);
  progress.show("mend, cancel or leave", 0.99);
  record.repairs = repair_list(record.result, record.options);
  progress.finish();
  if (record.undeclared_effect != 0) {
    rig::open_effect(folder.path(), session.open_effect(), kVerdictFile);
    record.truth = truth_of(session.open_effect());
  }
  write_files(record, arguments.lab.rig, folder);
  folder.publish(every_name());
  print_result(record);
}

void run_live(const Arguments& arguments) {
  runtime::Stop stop;
  report::require_gnuplot();
  const std::filesystem::path& out = arguments.lab.out;
  const std::filesystem::path recording = out / "session.mcap";
  LoopRecord record = new_record(arguments);
  record.options.progress = [&](const std::string& /*step*/) { return !stop.requested(); };
  record.options.aside = [](const std::function<void()>& work) {
    const runtime::OrdinaryWhile ordinary;
    work();
  };
  lab::LiveSession live = lab::run_session(arguments.lab, stop, [&](lab::LiveTrials& trials) {
    LiveTrialSession session(trials, recording);
    record.result = close_loop(session, record.options);
  });
  if (record.result.rounds.empty()) throw diagnosis::Interrupted();
  judge_cancellation(recording, live.outcomes, lab::answers_of(arguments.lab), record.result);
  record.conditions = own_trials(record.result);
  record.decision = decide(record.conditions, record.result);
  record.repairs = repair_list(record.result, record.options);
  // The verdict is written before the truth is opened.
  recording::write_file(out / kVerdictFile, verdict_json(record.result.verdict()));
  if (!live.sealed.empty()) {
    lab::open_undeclared_effect(arguments.lab, live, kVerdictFile);
    record.truth = truth_of(recording::read_file((out / rig::kSealedFile).string()));
  }
  live.folder.reset();
  report::StagedFolder folder(out);
  write_files(record, arguments.lab.rig, folder);
  folder.publish({});
  print_result(record);
}

// Effect, subject and repeats of a run in one process.
void add_comparison_options(command_line::Command& verb,
                            const std::shared_ptr<Arguments>& arguments,
                            command_line::Option effect, command_line::Option live) {
  verb.add_flag("--off-catalogue", arguments->off_catalogue,
                "the effect is one that no kind of `stillhand diagnose` describes")
      .needs(effect)
      .excludes(live);
  verb.add_option("--repeats", arguments->repeats,
                  "trials of each condition, with other draws of target, motion and remnant; with "
                  "--live one")
      .between(1, 1000)
      .excludes(live);
  verb.add_option(
          "--subject", arguments->lab.subject,
          "number of the subject that `stillhand study --seed` draws; 0: the one in the settings")
      .between(0, 10000);
  verb.add_option("--threads", arguments->threads,
                  "number of threads; the results do not depend on it; 0: one per core")
      .between(0, 256);
}

}  // namespace

void add_closed_loop_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  lab::LabOptions& lab = arguments->lab;
  lab::set_places(lab);
  lab.headless = true;
  lab.subject = 1;
  lab.protocol.identify_s = 120.0;  // paper III-A
  lab.protocol.conditions = session::parse_conditions("A,B,C");
  command_line::Command verb = cli.add_subcommand(
      "close-the-loop",
      "Adds to the canceller what its model lacks. The verb identifies with the stick pegged, runs "
      "A,\nB and C with the paper's model, diagnoses the recordings, adds the effects to the model "
      "and runs\nC again (C+). It repeats this until it finds nothing new or C+ no longer "
      "improves. With --pegged\nit works on recordings, without a rig.\nExamples: stillhand "
      "close-the-loop --undeclared-effect 7 --out loop1\n          stillhand close-the-loop "
      "--pegged day1.csv day2.csv --out loop2");
  command_line::Option effect =
      verb.add_option(
              "--undeclared-effect", lab.undeclared_effect,
              "seed of an effect that only the rig knows, revealed after the verdict; 0: none")
          .check(session::check_seed);
  command_line::Option seed =
      verb.add_option("--seed", lab.protocol.seed, "seed of everything else that is random")
          .check(session::check_seed);
  verb.add_option("--out", lab.out, "folder of report, figures and numbers").required();
  command_line::Option trial =
      verb.add_option("--trial-seconds", lab.protocol.trial_s, "length of a tracking trial [s]");
  command_line::Option identify =
      verb.add_option("--identify-seconds", lab.protocol.identify_s,
                      "length of the pegged trial [s]; the paper's is 120");
  command_line::Option live =
      verb.add_flag("--live", arguments->live,
                    "over DDS, with every process, in real time; the recording is kept");
  verb.add_option("--domain", lab.domain, "with --live: DDS domain, 0 to 232").needs(live);
  verb.add_option("--rig", lab.rig, "number of the rig on the bus, which the model names");
  add_comparison_options(verb, arguments, effect, live);
  diagnose::add_diagnose_options(verb, arguments->recorded.diagnose);
  arguments->recorded.declared = declared_drive(session::CoreConfigs{}.rig);
  add_recorded_options(verb, arguments->recorded,
                       {effect, seed, trial, identify, live, verb.get_option("--repeats"),
                        verb.get_option("--subject")});
  verb.callback([arguments, &status] {
    if (!arguments->recorded.pegged.empty()) {
      run_recorded(arguments->recorded, arguments->lab.out, arguments->lab.rig,
                   threads_of(*arguments));
    } else {
      arguments->live ? run_live(*arguments) : run_in_process(*arguments);
    }
    report::say_report(arguments->lab.out);
    status = 0;
  });
}

}  // namespace stillhand::close_the_loop
