// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/control_model_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/close_the_loop/control_model.hpp"
#include "apps/close_the_loop/drive.hpp"
#include "apps/close_the_loop/output.hpp"
#include "apps/lab/lab_options.hpp"
#include "apps/measurement/read_options.hpp"
#include "apps/report/provenance.hpp"
#include "apps/report/result_files.hpp"
#include "services/cancellation/control_model_file.hpp"
#include "services/contract/config_error.hpp"
#include "services/diagnosis/core/working_set.hpp"
#include "services/diagnosis/model_file.hpp"
#include "services/recording/file_io.hpp"
#include "services/rig/digest.hpp"
#include "services/settings/check_name.hpp"
#include "services/settings/check_number.hpp"
#include "services/settings/load.hpp"

namespace stillhand::close_the_loop {
namespace {

struct ControlModelWords {
  std::filesystem::path model;
  std::string recording;
  measurement::ReadOptions read;
  std::filesystem::path save;
  std::filesystem::path json;
  std::filesystem::path config;
  std::uint32_t rig = 1;
  double lead_ms = 1e3 * DeclaredDrive{}.motor_delay_s;
  bool as_it_is = false;
};

// What is known of an effect's force, for people.
std::string difference_of(const Treatment& treatment) {
  if (!treatment.difference) return {};
  return fmt::format(
      "; its force differs by {:.2g} % from the diagnosed one, and by {:.2g} % over "
      "another motion",
      100.0 * treatment.difference->source, 100.0 * treatment.difference->second);
}

std::string summary_of(const ConvertedModel& control) {
  const nlohmann::ordered_json summary{{"conversion_error", control.conversion_error},
                                       {"treatments", treatments_json(control)}};
  return summary.dump(2) + "\n";
}

// The ranges of the tables, and the body of a model without what is left alone, come from it.
// @throws stillhand::ConfigError for a recording that the model does not name
void require_diagnosed(const ControlModelWords& words, const std::string& model) {
  const auto origin = report::provenance_in(model);
  if (!origin || !std::filesystem::is_regular_file(words.recording)) return;
  const std::string digest = rig::sha256_of_file(words.recording);
  std::string names;
  for (const report::SourceFile& source : origin->sources) {
    if (source.sha256.empty() || source.sha256 == digest) return;
    names += (names.empty() ? "'" : ", '") + source.name + "'";
  }
  if (names.empty()) return;
  throw ConfigError(words.recording,
                    "another recording than " + words.model.string() + " was fitted to",
                    "the one that was diagnosed: " + names);
}

int run(const ControlModelWords& words) {
  report::ResultFiles files({{"--save", words.save}, {"--json", words.json}},
                            {words.model, words.recording});
  const std::string text = recording::read_file(words.model.string());
  const diagnosis::CarriedModel carried =
      diagnosis::parse_carried_model(text, words.model.string());
  require_diagnosed(words, text);
  const diagnosis::Model& model = carried.in_session;
  const diagnosis::Measurement whole = measurement::read_measurement(words.recording, words.read);
  const std::size_t factor = diagnosis::rate_factor(whole, model.rate_hz);
  const diagnosis::Signals signals(factor == 1 ? whole : diagnosis::decimated(whole, factor),
                                   model.inputs, model.output);
  ControlOptions options;
  options.lead_s = 1e-3 * words.lead_ms;
  ConvertedModel control = to_control_model(carried, signals, options);
  if (!words.as_it_is) control.model.adapts = average_hand();
  cancellation::require_sound(
      control.model,
      settings::load<cancellation::Config>(words.config / "cancellation.yaml", "cancellation"),
      words.model.string());
  files.set("--save", cancellation::control_model_json(control.model, words.rig));
  if (!words.json.empty()) files.set_json("--json", summary_of(control));
  files.publish();
  std::printf("%s at 1 kHz, off by at most %.2g %% from %g to %g Hz, in %s\n",
              words.model.string().c_str(), 100.0 * control.conversion_error, options.low_hz,
              options.high_hz, words.save.string().c_str());
  for (const Treatment& each : control.treatments) {
    std::printf("%s: %s: %s%s\n", each.kind.c_str(), each.cancelled ? "cancelled" : "left alone",
                each.how.c_str(), difference_of(each).c_str());
  }
  return 0;
}

}  // namespace

void add_control_model_command(CLI::App& cli, int& status) {
  auto words = std::make_shared<ControlModelWords>();
  lab::LabOptions places;
  lab::set_places(places);
  words->config = places.config;
  CLI::App* verb = cli.add_subcommand(
      "control-model",
      "Converts a model that `stillhand diagnose --save` wrote to the canceller's 1 kHz, for\n"
      "`stillhand lab --model`, and prints for each effect what the motor will do about it.\n"
      "The converted effect runs next to the diagnosed one, over REC and over another motion of "
      "the\n"
      "same spectrum: where the forces differ by more than 1 %, the effect is left alone.\n"
      "REC is the recording that was diagnosed: its ranges are those of the model's tables.\n"
      "Example: stillhand control-model model.json run1/session.mcap --trial I --save "
      "control.json");
  verb->add_option("MODEL", words->model, "model file")->required();
  verb->add_option("REC", words->recording, "recording: MCAP, CSV, MATLAB, HDF5 or sound")
      ->required();
  verb->add_option("--trial", words->read.trial,
                   "trial of a session's recording: its number, or the letter of its condition");
  measurement::add_read_options(*verb, words->read);
  verb->add_option("--save", words->save, "file of the control model")
      ->required()
      ->check(settings::check_name);
  verb->add_option("--json", words->json,
                   "file of what becomes of each effect, with the difference of its force")
      ->check(settings::check_name);
  verb->add_option("--rig", words->rig, "number of the rig that the model is for")
      ->capture_default_str();
  verb->add_option("--lead-ms", words->lead_ms,
                   "delay of the motor [ms]: the prediction comes as much sooner")
      ->check(settings::number_between(0.0, 100.0))
      ->capture_default_str();
  verb->add_flag("--as-it-is", words->as_it_is, "gain and phase do not adapt while it runs");
  verb->add_option("--config", words->config,
                   "folder with the settings of each service: the canceller's bounds")
      ->capture_default_str();
  verb->callback([words, &status] { status = run(*words); });
}

}  // namespace stillhand::close_the_loop
