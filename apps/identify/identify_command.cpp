// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/identify/admittance.hpp"
#include "apps/identify/identify.hpp"
#include "apps/identify/identify_output.hpp"
#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/identification/model_file.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::identify {
namespace {

struct Arguments {
  bool admittance = false;
  double lever_m = 0.1;  // of the paper's stick
  std::filesystem::path picture;
  std::string held, swapped;
  std::string recording;
  measurement::ReadOptions read;
  IdentifyOptions identify;
  std::filesystem::path save;
  std::filesystem::path json;
};

int run_admittance(const Arguments& arguments) {
  if (!arguments.save.empty()) {
    throw ConfigError("--save", "it with --admittance", "it without: a model for the canceller");
  }
  if (arguments.held.empty() != arguments.swapped.empty()) {
    throw ConfigError(arguments.held.empty() ? "--held" : "--swapped", "nothing",
                      "both or neither: their relation needs three sessions");
  }
  report::ResultFiles files({{"--json", arguments.json}, {"--picture", arguments.picture}},
                            {arguments.recording, arguments.held, arguments.swapped});
  const AdmittanceResult result = identify_admittance(
      {arguments.recording, arguments.held, arguments.swapped}, arguments.lever_m);
  if (files.wants("--json")) files.set_json("--json", result_json(result));
  if (files.wants("--picture")) {
    const std::vector<report::Figure> figures{figure(result)};
    files.set("--picture", report::draw(figures).front().png);
  }
  files.publish();
  std::fputs(result_table(result).c_str(), stdout);
  return 0;
}

int run(const Arguments& arguments) {
  if (arguments.admittance) return run_admittance(arguments);
  if (!arguments.picture.empty() || !arguments.held.empty() || !arguments.swapped.empty()) {
    throw ConfigError(!arguments.picture.empty() ? "--picture"
                      : !arguments.held.empty()  ? "--held"
                                                 : "--swapped",
                      "it without --admittance", "it with --admittance");
  }
  report::ResultFiles files({{"--save", arguments.save}, {"--json", arguments.json}},
                            {arguments.recording, arguments.read.map_file});
  measurement::ReadOptions read = arguments.read;
  read.channels = {{arguments.identify.input}, arguments.identify.output};
  const diagnosis::Measurement measured = measurement::read_measurement(arguments.recording, read);
  measurement::require_channels(measured, {arguments.identify.input, arguments.identify.output},
                                read, "--input, --output");
  const IdentifyResult result = identify(measured, arguments.identify);
  const bool to_diagnose = result.unusable.empty() || result.reason == "effects";
  if (files.wants("--save")) {
    if (!result.unusable.empty()) {
      throw ConfigError("--save", "a model that can't cancel (" + result.unusable + ")",
                        "no --save; " + (to_diagnose ? "`stillhand diagnose` adds what it lacks"
                                                     : measurement::step_for(result.reason)));
    }
    files.set_json("--save", identification::model_json(result.model));
  }
  if (files.wants("--json")) files.set_json("--json", result_json(result));
  files.publish();
  std::fputs(result_table(result).c_str(), stdout);
  report::say_next(to_diagnose
                       ? "stillhand diagnose " + report::quoted_for_shell(arguments.recording) +
                             measurement::words_of(arguments.read) + " says what this model lacks"
                       : measurement::step_for(result.reason));
  return 0;
}

}  // namespace

void add_identify_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  command_line::Command verb = cli.add_subcommand(
      "identify",
      "Fits the paper's model to one recording: a difference model by least squares at 50 "
      "Hz.\nReports its frequency response next to the measured one, and its error on the quarter "
      "of\nthe recording that the fit did not see. REC is the MCAP file of a session, or a CSV, "
      "MATLAB,\nHDF5, ROS 2 (MCAP) or sound file at 100 Hz or more, with columns 'name [unit]' and "
      "'t [s]',\nor with other columns and --map. Result files replace earlier ones, all together "
      "or not at all.\nExamples: stillhand identify demo/session.mcap --save model.json --json "
      "out.json\n          stillhand identify ride.csv --map 'time=t [s]' 'acc=a_y [m/s^2]' "
      "'force=f [N]'");
  verb.add_option("REC", arguments->recording, "recording").required();
  verb.add_option("--order", arguments->identify.config.order, "order of the model").between(1, 12);
  verb.add_flag("--refine", arguments->identify.config.refine,
                "refine the fit on its free-run error (the model predicts from the input alone); "
                "the verb does "
                "so by itself if the fit is unstable");
  verb.add_option("--input", arguments->identify.input, "input channel of the model");
  verb.add_option("--output", arguments->identify.output, "output channel of the model");
  verb.add_option(
      "--trial", arguments->read.trial,
      "trial of a session: number, or letter of its condition (I, A, B, C) [identification]");
  measurement::add_read_options(verb, arguments->read);
  measurement::add_heaviest_option(verb, arguments->identify.heaviest_kg);
  verb.add_option("--save", arguments->save,
                  "file for the model, in the form that cancellation reads")
      .check(settings::check_name);
  verb.add_option("--json", arguments->json, "file for all results; - is standard output")
      .check(settings::check_name);
  verb.add_flag(
      "--admittance", arguments->admittance,
      "for a session of `stillhand lab --identify admittance,feedthrough`: print admittance and "
      "feedthrough of the free stick with 95 % bands, and a physical model of the arm");
  verb.add_option("--lever-m", arguments->lever_m,
                  "with --admittance: distance from hand to pivot [m]")
      .check(settings::number_between(0.02, 0.5));
  verb.add_option("--picture", arguments->picture, "with --admittance: PNG file for the responses")
      .check(settings::check_name);
  verb.add_option(
      "--held", arguments->held,
      "with --admittance: a session of `lab --held-stick`. With --swapped too, the verb tests that "
      "the feedthrough to position is the feedthrough to force times the admittance");
  verb.add_option("--swapped", arguments->swapped,
                  "with --admittance: a session of `lab --swap-lines`");
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::identify
