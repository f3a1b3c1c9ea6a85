// SPDX-License-Identifier: Apache-2.0
#include "apps/identify/identify_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/identify/admittance.hpp"
#include "apps/identify/identify.hpp"
#include "apps/identify/identify_output.hpp"
#include "apps/measurement/read_options.hpp"
#include "apps/report/plot/draw.hpp"
#include "apps/report/result_files.hpp"
#include "apps/report/text.hpp"
#include "services/contract/config_error.hpp"
#include "services/identification/model_file.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::identify {
namespace {

struct Words {
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

int run_admittance(const Words& words) {
  if (!words.save.empty()) {
    throw ConfigError("--save", "it with --admittance", "it without: a model for the canceller");
  }
  if (words.held.empty() != words.swapped.empty()) {
    throw ConfigError(words.held.empty() ? "--held" : "--swapped", "nothing",
                      "both or neither: their relation needs three sessions");
  }
  report::ResultFiles files({{"--json", words.json}, {"--picture", words.picture}},
                            {words.recording, words.held, words.swapped});
  const AdmittanceResult result =
      identify_admittance({words.recording, words.held, words.swapped}, words.lever_m);
  if (files.wants("--json")) files.set_json("--json", result_json(result));
  if (files.wants("--picture")) {
    const std::vector<report::Figure> figures{figure(result)};
    files.set("--picture", report::draw(figures).front().png);
  }
  files.publish();
  std::fputs(result_table(result).c_str(), stdout);
  return 0;
}

int run(const Words& words) {
  if (words.admittance) return run_admittance(words);
  if (!words.picture.empty() || !words.held.empty() || !words.swapped.empty()) {
    throw ConfigError(!words.picture.empty() ? "--picture"
                      : !words.held.empty()  ? "--held"
                                             : "--swapped",
                      "it without --admittance", "it with --admittance");
  }
  report::ResultFiles files({{"--save", words.save}, {"--json", words.json}},
                            {words.recording, words.read.map_file});
  const IdentifyResult result =
      identify(measurement::read_measurement(words.recording, words.read), words.identify);
  if (files.wants("--save")) {
    if (!result.unusable.empty()) {
      throw ConfigError("--save", "a model that can't cancel (" + result.unusable + ")",
                        "no --save, or another --order");
    }
    files.set_json("--save", identification::model_json(result.model));
  }
  if (files.wants("--json")) files.set_json("--json", result_json(result));
  files.publish();
  std::fputs(result_table(result).c_str(), stdout);
  report::say_next("stillhand diagnose " + words.recording + " says what this model lacks");
  return 0;
}

}  // namespace

void add_identify_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  CLI::App* verb = cli.add_subcommand(
      "identify",
      "Fits the paper's model to one recording: a difference model by least squares at 50 Hz.\n"
      "Reports its frequency response next to the measured one, and its error on the quarter of\n"
      "the recording that the fit did not see. REC is the MCAP file of a session, or a CSV, "
      "MATLAB,\n"
      "HDF5, ROS 2 (MCAP) or sound file at 100 Hz or more, with columns 'name [unit]' and 't "
      "[s]',\n"
      "or with others and --map. Files of earlier results are replaced; they appear together or\n"
      "not at all.\n"
      "Examples: stillhand identify demo/session.mcap --save model.json --json out.json\n"
      "          stillhand identify ride.csv --map 'time=t [s]' 'acc=a_y [m/s^2]' 'force=f [N]'");
  verb->add_option("REC", words->recording, "recording")->required();
  verb->add_option("--order", words->identify.config.order, "order of the model, 1 to 12")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  verb->add_flag("--refine", words->identify.config.refine,
                 "refine the least squares on its free-run error; also done if it is unstable");
  verb->add_option("--input", words->identify.input, "input channel of the model")
      ->capture_default_str();
  verb->add_option("--output", words->identify.output, "output channel of the model")
      ->capture_default_str();
  verb->add_option(
      "--trial", words->read.trial,
      "trial of a session: number, or letter of its condition (I, A, B, C) [identification]");
  measurement::add_read_options(*verb, words->read);
  verb->add_option("--save", words->save, "file for the model, in the form that cancellation reads")
      ->check(settings::check_name);
  verb->add_option("--json", words->json, "file for all results")->check(settings::check_name);
  verb->add_flag(
      "--admittance", words->admittance,
      "REC is a session of `stillhand lab --identify admittance,feedthrough`: admittance "
      "and feedthrough of the free stick with 95 % bands, and a physical arm");
  verb->add_option("--lever-m", words->lever_m, "of --admittance: hand to pivot [m]")
      ->check(CLI::Range(0.02, 0.5))
      ->capture_default_str();
  verb->add_option("--picture", words->picture, "of --admittance: PNG file for the responses")
      ->check(settings::check_name);
  verb->add_option("--held", words->held,
                   "of --admittance: session with --held-stick; with --swapped it tests that "
                   "feedthrough to position is feedthrough to force times deflection per force");
  verb->add_option("--swapped", words->swapped, "of --admittance: session with --swap-lines");
  verb->callback([words, &status] { status = run(*words); });
}

}  // namespace stillhand::identify
