// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded_command.hpp"

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/recorded_output.hpp"
#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/system/process/run_jobs.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::close_the_loop {
namespace {

// A record that is fitted to must not judge the fit.
void check_apart(const RecordedOptions& options) {
  std::vector<std::string> all = options.pegged;
  all.insert(all.end(), options.unseen.begin(), options.unseen.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code error;
      if (!std::filesystem::equivalent(all[i], all[j], error)) continue;
      throw ConfigError(i < options.pegged.size() ? "--pegged" : "--unseen",
                        all[j] + " and " + all[i] + ", the same file", "each recording once");
    }
  }
}

// The model for `stillhand lab --model`; none where no motor could run.
std::optional<cancellation::ControlModel> control_model_of(const RecordedLoop& loop) {
  if (!loop.decision.kept()) return loop.linear_control;
  if (!loop.no_motor.empty() || !loop.verdict.not_carried.empty()) return std::nullopt;
  return loop.verdict.control.model;
}

// What this run would replace or stand next to.
void check_folder(const RecordedOptions& options, const std::filesystem::path& out) {
  std::error_code error;
  if (std::filesystem::exists(out / "session.mcap", error)) {
    throw ConfigError("--out", out.string() + ", which holds the recording of a session",
                      "a folder without one");
  }
  for (const auto* files :
       {&options.pegged, &options.moving, &options.cancelled, &options.unseen}) {
    for (const std::string& file : *files) {
      for (const std::string& name : every_name()) {
        if (!std::filesystem::equivalent(file, out / name, error)) continue;
        throw ConfigError("--out", file + ", which is read and would be replaced",
                          "another folder");
      }
    }
  }
}

command_line::Option add_files(command_line::Command& verb, const char* name,
                               std::vector<std::string>& files, const char* help) {
  return verb.add_option(name, files, help).existing_file().group("From recordings");
}

}  // namespace

void add_recorded_options(command_line::Command& verb, RecordedOptions& options,
                          const std::vector<command_line::Option>& others) {
  command_line::Option pegged = add_files(
      verb, "--pegged", options.pegged,
      "recording(s) with the stick held, MCAP, CSV, MATLAB, HDF5 or sound: closes the loop "
      "from recordings, without a rig");
  add_files(verb, "--moving", options.moving,
            "recording(s) of condition B, 1 kHz with theta, f and f_motor: friction and ripple")
      .needs(pegged);
  add_files(verb, "--cancelled", options.cancelled,
            "recording(s) of condition C, with the same channels: the delay of motor and load cell")
      .needs(pegged);
  add_files(verb, "--unseen", options.unseen,
            "pegged recording(s) that judge the model [the last of --pegged, or its last 30 %]")
      .needs(pegged);
  verb.add_option("--input", options.diagnose.inputs,
                  "inputs of the model: channel(s), comma-separated")
      .delimiter(',')
      .takes_all()
      .expected(1, 1)
      .needs(pegged)
      .group("From recordings");
  verb.add_option("--output", options.diagnose.output, "channel that the model predicts")
      .needs(pegged)
      .group("From recordings");
  for (command_line::Option option : measurement::add_read_options(verb, options.read)) {
    option.needs(pegged);
  }
  for (command_line::Option other : others) pegged.excludes(other);
}

void run_recorded(RecordedOptions options, const std::filesystem::path& out, std::uint32_t rig,
                  unsigned threads) {
  runtime::Stop stop;
  check_apart(options);
  check_folder(options, out);
  report::StagedFolder folder(out);
  const runtime::EndAfterStop end(stop, [&] { folder.clear_away(); });
  report::require_gnuplot();
  report::ProgressLine progress;
  double done = 0.0;
  options.progress = [&](const std::string& step) {
    progress.show(step, done);
    done += 0.3 * (1.0 - done);  // the number of steps is not known in advance
    return !stop.requested();
  };
  options.diagnose.for_each = [threads](std::size_t count, const auto& job) {
    runtime::run_jobs(count, threads, job);
  };
  const RecordedLoop loop = close_recorded_loop(options);
  progress.finish();
  folder.write(kVerdictFile, verdict_json(loop.verdict));
  folder.write("summary.json", recorded_summary_json(loop, options));
  folder.write("model.json",
               diagnosis::model_json(loop.verdict.body.model, loop.verdict.body.carried,
                                     loop.verdict.body.baseline.model));
  if (auto model = control_model_of(loop)) {
    model->adapts = average_hand();
    folder.write(kControlModelFile, cancellation::control_model_json(*model, rig));
  }
  const auto drawings = report::render(recorded_figures(loop), folder.path());
  recorded_page(loop, options, report::command_line(), drawings)
      .write(folder.path() / "report.html");
  folder.publish(every_name());
  print_recorded(loop);
}

}  // namespace stillhand::close_the_loop
