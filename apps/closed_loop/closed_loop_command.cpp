// SPDX-License-Identifier: Apache-2.0
#include "closed_loop/closed_loop_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "cancellation/core/command_filter.hpp"
#include "closed_loop/output.hpp"
#include "diagnose/on_all_cores.hpp"
#include "diagnosis/model_file.hpp"
#include "experiment/progress.hpp"
#include "report/command_line.hpp"
#include "report/draw.hpp"
#include "report/staged_folder.hpp"
#include "rig/sealed_file.hpp"
#include "runtime/stop.hpp"

namespace stillhand::closed_loop {
namespace {

struct Words {
  experiment::ProtocolOptions protocol;
  std::uint64_t undeclared_effect = 0;
  std::filesystem::path out;
};

// Steps of one way through the loop, for the bar.
constexpr double kUsualSteps = 14.0;

cancellation::HandCompliance average_hand() {
  const cancellation::CommandFilterConfig average;
  return {average.mass_kg, average.damping_n_s_m, average.stiffness_n_m, average.lever_m};
}

DeclaredDrive declared_drive(const rig::RigConfig& rig) {
  return {rig.stick, kControlPeriod_s + rig.motor.lag_s};
}

int run(const Words& words) {
  runtime::Stop stop;
  report::StagedFolder folder(words.out);
  report::require_gnuplot();
  LoopRecord record;
  record.undeclared_effect = words.undeclared_effect;
  record.options.protocol = words.protocol;
  record.command_line = report::command_line();
  const experiment::CoreConfigs configs;
  record.options.declared = declared_drive(configs.rig);
  record.options.hand = average_hand();
  record.options.for_each = diagnose::on_all_cores;
  experiment::ProgressLine progress;
  int steps = 0;
  record.options.progress = [&](const std::string& step) {
    progress.show(step, std::min(steps++ / kUsualSteps, 0.98));
    return !stop.requested();
  };
  InProcessSession session(configs, words.protocol.seed, words.undeclared_effect);
  if (words.undeclared_effect != 0) {
    std::printf("undeclared effect sealed, sha256 %.64s\n", session.commitment().c_str());
    folder.write(rig::kCommitmentFile, session.commitment());
  }
  record.result = close_loop(session, record.options);
  progress.finish();
  folder.write(kVerdictFile, verdict_json(record.result));
  folder.write("model.json", diagnosis::model_json(record.result.verdict().body.model));
  if (words.undeclared_effect != 0) {
    const std::string truth = session.open_effect();
    rig::open_effect(folder.path(), truth, kVerdictFile);
    record.truth = truth_of(truth);
  }
  folder.write("summary.json", summary_json(record));
  const auto drawings = report::render(loop_figures(record), folder.path());
  loop_page(record, drawings).write(folder.path() / "report.html");
  folder.publish(every_name());
  print_result(record);
  std::printf("report in %s\n", words.out.string().c_str());
  return 0;
}

}  // namespace

void add_closed_loop_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  words->protocol.identify_s = 120.0;  // paper III-A
  words->protocol.conditions = experiment::parse_conditions("A,B,C");
  CLI::App* verb =
      cli.add_subcommand("close-the-loop",
                         "What the model lacks goes back into the canceller: identifies with the "
                         "stick pegged, runs A, "
                         "B and C\n"
                         "with the paper's model, diagnoses the recordings, augments the model, "
                         "and runs C again (C+), "
                         "until\n"
                         "nothing new is found or nothing helps.\n"
                         "Example: stillhand close-the-loop --undeclared-effect 7 --out loop1");
  verb->add_option(
          "--undeclared-effect", words->undeclared_effect,
          "seed of an effect that only the rig knows of, opened after the verdict; 0: none")
      ->check(experiment::check_seed)
      ->capture_default_str();
  verb->add_option("--seed", words->protocol.seed, "seed of everything else that is random")
      ->check(experiment::check_seed)
      ->capture_default_str();
  verb->add_option("--out", words->out, "folder of report, figures and numbers")->required();
  verb->add_option("--trial-seconds", words->protocol.trial_s, "length of a tracking trial [s]")
      ->capture_default_str();
  verb->add_option("--identify-seconds", words->protocol.identify_s,
                   "length of the pegged trial [s]; the paper's is 120")
      ->capture_default_str();
  verb->callback([words, &status] { status = run(*words); });
}

}  // namespace stillhand::closed_loop
