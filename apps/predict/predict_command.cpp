// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/predict_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/measurement/read_options.hpp"
#include "apps/predict/predict.hpp"
#include "apps/report/result_files.hpp"
#include "services/diagnosis/model_file.hpp"
#include "services/recording/core/csv.hpp"
#include "services/recording/file_io.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::predict {
namespace {

struct Words {
  std::filesystem::path model;
  std::string recording;
  measurement::ReadOptions read;
  std::filesystem::path out;
};

int run(const Words& words) {
  report::ResultFiles files({{"--out", words.out}},
                            {words.model, words.recording, words.read.map_file});
  const diagnosis::CarriedModel carried = diagnosis::parse_carried_model(
      recording::read_file(words.model.string()), words.model.string());
  const diagnosis::Model& model = carried.model;
  const Prediction prediction =
      predict(carried, measurement::read_measurement(words.recording, words.read));
  files.set("--out", recording::to_csv(prediction.table));
  files.publish();
  std::printf("%zu samples of %s from", prediction.table.row_count(), model.output.c_str());
  for (const std::string& input : model.inputs) std::printf(" %s", input.c_str());
  std::printf(" in %s\n", words.out.string().c_str());
  for (const std::string& note : prediction.notes) std::printf("note: %s\n", note.c_str());
  return 0;
}

}  // namespace

void add_predict_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<Words>();
  CLI::App* verb = cli.add_subcommand(
      "predict",
      "Runs a model that `stillhand diagnose --save` wrote over a recording's inputs alone.\n"
      "The recording need not hold the output. Effects that another recording does not share (a\n"
      "tone, a drift, a burst, a changing gain) are left out; beyond the range in which it was\n"
      "seen, an effect is held at its edge. A note reports each.\n"
      "Example: stillhand predict model.json ride.csv --out prediction.csv");
  verb->add_option("MODEL", words->model, "model file")->required();
  verb->add_option("REC", words->recording, "recording: MCAP, CSV, MATLAB, HDF5 or sound")
      ->required();
  verb->add_option("--trial", words->read.trial,
                   "trial of a session's recording: its number, or the letter of its condition");
  measurement::add_read_options(*verb, words->read);
  verb->add_option("--out", words->out, "CSV file of the prediction")
      ->required()
      ->check(settings::check_name);
  verb->callback([words, &status] { status = run(*words); });
}

}  // namespace stillhand::predict
