// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/predict_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "apps/predict/judgement.hpp"
#include "apps/predict/predict.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/digest/content_digest.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::predict {
namespace {

struct Arguments {
  std::filesystem::path model;
  std::string recording;
  measurement::ReadOptions read;
  std::filesystem::path out;
  std::filesystem::path json;
  std::filesystem::path picture;
  std::size_t start_samples = 0;
};

// The model file, and what predicts from it.
struct Models {
  diagnosis::CarriedModel carried;
  std::optional<diagnosis::Model> linear;
  std::optional<report::Provenance> origin;
};

Models read_models(const std::filesystem::path& path) {
  const std::string text = recording::read_file(path.string());
  Models models{diagnosis::parse_carried_model(text, path.string()),
                diagnosis::parse_linear_model(text, path.string()), report::provenance_in(text)};
  digest::require_as_written(text, path.string());
  return models;
}

// --picture: the format by the name's ending.
bool is_svg(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (!path.empty() && ending != ".svg" && ending != ".png") {
    throw ConfigError("--picture", path.string(), "a name that ends in .png or .svg");
  }
  return ending == ".svg";
}

void print(const Arguments& arguments, const Models& models, const Prediction& prediction,
           const std::optional<Judgement>& judgement) {
  std::printf("%zu samples of %s from", prediction.table.row_count(), prediction.output.c_str());
  for (const std::string& input : models.carried.model.inputs) {
    std::printf(" %s", input.c_str());
  }
  std::printf(" in %s\n", arguments.out.string().c_str());
  if (models.origin) std::printf("model    %s\n", report::in_words(*models.origin).c_str());
  if (judgement) std::fputs(judgement_table(*judgement).c_str(), stdout);
  for (const std::string& note : prediction.notes) {
    std::printf("note: %s\n", note.c_str());
  }
}

int run(const Arguments& arguments) {
  report::ResultFiles files(
      {{"--out", arguments.out}, {"--json", arguments.json}, {"--picture", arguments.picture}},
      {arguments.model, arguments.recording, arguments.read.map_file});
  const bool svg = is_svg(arguments.picture);
  if (files.wants("--picture")) report::require_gnuplot();
  const Models models = read_models(arguments.model);
  measurement::ReadOptions read = arguments.read;
  read.channels = {models.carried.model.inputs, models.carried.model.output};
  const diagnosis::Measurement measured = measurement::read_measurement(arguments.recording, read);
  measurement::require_channels(measured, models.carried.model.inputs, read);
  Prediction prediction = predict(models.carried, measured, arguments.start_samples);
  const std::optional<Judgement> judgement =
      judged(prediction, models.linear, measured, arguments.start_samples);
  if (files.wants("--json")) {
    files.set("--json", judgement_json(prediction, judgement, models.origin));
  }
  if (files.wants("--picture")) {
    if (!judgement) {
      const bool held = measured.find(prediction.output) != nullptr;
      throw ConfigError("--picture",
                        held ? prediction.notes.back()
                             : arguments.recording + " without '" + prediction.output + "'",
                        "a recording that holds the output");
    }
    const std::vector<report::Figure> figures{judgement_figure(*judgement)};
    report::Drawing drawing = std::move(report::draw(figures).front());
    files.set("--picture", std::move(svg ? drawing.svg : drawing.png));
  }
  if (judgement) prediction.table.columns.push_back(judgement->measured);
  files.set("--out", recording::to_csv(prediction.table));
  files.publish();
  print(arguments, models, prediction, judgement);
  if (arguments.picture.empty() && judgement) {
    report::say_next("the same command with --picture prediction.png draws an excerpt");
  }
  return 0;
}

}  // namespace

void add_predict_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  command_line::Command verb = cli.add_subcommand(
      "predict",
      "Runs a model that `stillhand diagnose --save` wrote over a recording's inputs alone.\nIf "
      "the recording holds the output too, the verb prints RMSE, VAF (the share of the variance\n"
      "that is explained) and fit, of the linear model and of the one with effects. A tone, a "
      "drift,\na burst and a changing gain belong to one recording and are left out. Outside of "
      "the "
      "range\nthat was seen, an effect keeps its value. A note reports each case.\nExample: "
      "stillhand "
      "predict model.json ride.csv --out prediction.csv");
  verb.add_option("MODEL", arguments->model, "model file").required();
  measurement::add_recording_options(verb, arguments->recording, arguments->read);
  verb.add_option("--out", arguments->out,
                  "CSV file of the prediction, with the measured output if REC has it")
      .required()
      .check(settings::check_name);
  verb.add_option("--start-from-output", arguments->start_samples,
                  "rows at the start of REC whose measured output gives the model's state there; "
                  "the scores leave them out [0: the state comes from the inputs]")
      .default_str("")
      .between(0, 1000000);
  verb.add_option(
          "--json", arguments->json,
          "file for RMSE, VAF and fit of the model, without and with effects; - is standard "
          "output, and the text then goes to standard error")
      .check(settings::check_name);
  verb.add_option("--picture", arguments->picture,
                  "PNG or SVG file: an excerpt of the measured output, both predictions and their "
                  "residuals")
      .check(settings::check_name);
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::predict
