// SPDX-License-Identifier: Apache-2.0
#include "apps/plan_run/plan_run_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/diagnose/diagnose_options.hpp"
#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "apps/plan_run/plan_results.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/next_run/tie.hpp"
#include "services/files/next_run/plan_file.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/run_jobs.hpp"
#include "services/system/process/shipped.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::plan_run {
namespace {

struct Arguments {
  std::vector<std::string> recordings;
  measurement::ReadOptions read;
  diagnosis::DiagnoseOptions options;
  double seconds = 30.0;
  std::filesystem::path out;
  std::filesystem::path config = runtime::shipped("deploy/config");
};

// What the lab asks of the platform in the pegged trial of a plan.
next_run::Bounds bounds_of(const Arguments& arguments) {
  session::ProtocolOptions protocol;
  protocol.identify_s = arguments.seconds;
  protocol.planned = true;
  const auto platform =
      settings::load<motion::MotionGenerator::Config>(arguments.config / "motion.yaml", "motion");
  return {session::motion_profile(session::identification_trial(protocol)), platform.limits};
}

// [s] Other lengths that are judged.
std::vector<double> longer_s(const Arguments& arguments) {
  std::vector<double> seconds;
  for (const double times : {2.0, 4.0}) {
    if (times * arguments.seconds <= next_run::kLongest_s)
      seconds.push_back(times * arguments.seconds);
  }
  return seconds;
}

// The platform moves one input, as an acceleration.
void check_input(const diagnosis::Signals& signals) {
  const diagnosis::Signal& input = signals.inputs().front();
  if (input.quantity == diagnosis::Quantity::kAcceleration) return;
  throw ConfigError("--input", fmt::format("{} [{}]", input.name, input.unit),
                    "the platform's acceleration first, in m/s^2");
}

// The strongest effect's that the recording does not break.
next_run::Contest tie_of(const diagnosis::Diagnosis& verdict, const diagnosis::Signals& signals) {
  const auto ties = next_run::ties_of(verdict, signals);
  const auto tied = std::ranges::find_if_not(ties, &next_run::Tie::broken);
  if (tied != ties.end()) return {tied->left, signals};
  throw ConfigError("REC",
                    ties.empty() ? fmt::format("a verdict without a tie ({})", verdict.verdict())
                                 : ties.front().in_words(),
                    "a recording that two causes explain equally well");
}

void write_all(const Arguments& arguments, const Planned& planned, report::StagedFolder& folder) {
  const std::vector<std::filesystem::path> sources(arguments.recordings.begin(),
                                                   arguments.recordings.end());
  folder.write(next_run::kRideName, ride_csv(planned.plan.ride));
  folder.write("plan.json", report::with_provenance(plan_json(planned),
                                                    report::provenance_of_this_call(sources)));
  const std::vector<report::Figure> figures{plan_figure(planned)};
  folder.write("plan.svg", report::draw(figures).front().svg);
  folder.publish({next_run::kRideName, "plan.json", "plan.svg"});
}

int run(const Arguments& arguments) {
  runtime::Stop stop;
  report::require_gnuplot();
  report::StagedFolder folder(arguments.out);
  const runtime::EndAfterStop end(stop, [&] { folder.clear_away(); });
  const next_run::Bounds bounds = bounds_of(arguments);
  const diagnosis::Measurement measured = measurement::join(
      diagnose::read_recordings(arguments.recordings, arguments.read, arguments.options));
  report::ProgressLine progress;
  diagnosis::DiagnoseOptions options = arguments.options;
  options.for_each = runtime::on_all_cores;
  double done = 0.0;
  options.progress = [&](const std::string& step) {
    progress.show(step, done);
    done += 0.3 * (1.0 - done);
    return !stop.requested();
  };
  const diagnosis::Diagnosis verdict = diagnosis::diagnose(measured, options);
  const diagnosis::Measurement working = diagnosis::working_set(measured, options.inputs);
  const diagnosis::Signals signals(working, options.inputs, options.output);
  check_input(signals);
  const next_run::Contest contest = tie_of(verdict, signals);
  progress.show("designing", done);
  const next_run::Plan plan = next_run::best_plan(contest, working, bounds, runtime::on_all_cores);
  progress.finish();
  const Planned planned{contest,
                        plan,
                        bounds,
                        arguments.seconds,
                        advice_for(contest, plan, signals),
                        next_run::longer(plan, longer_s(arguments), contest, working, bounds)};
  write_all(arguments, planned, folder);
  std::fputs(plan_table(planned).c_str(), stdout);
  const std::string plan_file = report::quoted_for_shell((arguments.out / "plan.json").string());
  std::string recordings;
  for (const std::string& each : arguments.recordings) {
    recordings += report::quoted_for_shell(each) + " ";
  }
  report::say_next(
      fmt::format("stillhand lab --plan {0} --out NEW, and then stillhand diagnose {1}"
                  "NEW/session.mcap --plan {0}",
                  plan_file, recordings));
  return 0;
}

}  // namespace

void add_plan_run_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  command_line::Command verb = cli.add_subcommand(
      "plan-run",
      "Plans the run that settles a tie. Diagnoses the recording, takes the causes that "
      "explain\nit about equally well, and looks for the motion, within the platform's limits, on "
      "which their\npredictions differ most for the noise of the recording. It states the "
      "probability that the run\nbreaks the tie.\nREC: as for `stillhand diagnose`.\nExample: "
      "stillhand plan-run run1/session.mcap --seconds 30 --out next");
  diagnose::add_recordings(verb, arguments->recordings, arguments->read, arguments->options);
  verb.add_option("--seconds", arguments->seconds, "length of the run [s]")
      .check(settings::number_between(next_run::kShortest_s, next_run::kLongest_s));
  verb.add_option("--out", arguments->out, "folder for ride.csv, plan.json and plan.svg")
      .required()
      .check(settings::check_name);
  verb.add_option("--config", arguments->config,
                  "folder with the settings of each service; motion.yaml holds the platform's "
                  "limits");
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::plan_run
