// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/control_model_command.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/close_the_loop/verdict/drive.hpp"
#include "apps/lab/lab_options.hpp"
#include "apps/libraries/measurement/read_options.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "services/files/digest/content_digest.hpp"
#include "services/files/digest/digest.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::close_the_loop {
namespace {

struct ControlModelArguments {
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
void require_diagnosed(const ControlModelArguments& arguments, const std::string& model) {
  const auto origin = report::provenance_in(model);
  if (!origin || !std::filesystem::is_regular_file(arguments.recording)) return;
  const std::string digest = digest::sha256_of_file(arguments.recording);
  std::string names;
  for (const report::SourceFile& source : origin->sources) {
    if (source.sha256.empty() || source.sha256 == digest) return;
    names += (names.empty() ? "'" : ", '") + source.name + "'";
  }
  if (names.empty()) return;
  throw ConfigError(arguments.recording,
                    "another recording than " + arguments.model.string() + " was fitted to",
                    "the one that was diagnosed: " + names);
}

int run(const ControlModelArguments& arguments) {
  report::ResultFiles files({{"--save", arguments.save}, {"--json", arguments.json}},
                            {arguments.model, arguments.recording});
  const auto canceller =
      settings::load<cancellation::Config>(arguments.config / "cancellation.yaml", "cancellation");
  const std::string text = recording::read_file(arguments.model.string());
  const diagnosis::CarriedModel carried =
      diagnosis::parse_carried_model(text, arguments.model.string());
  digest::require_as_written(text, arguments.model.string());
  require_diagnosed(arguments, text);
  const diagnosis::Model& model = carried.in_session;
  const diagnosis::Measurement whole =
      measurement::read_measurement(arguments.recording, arguments.read);
  const std::size_t factor = diagnosis::rate_factor(whole, model.rate_hz);
  const diagnosis::Signals signals(factor == 1 ? whole : diagnosis::decimated(whole, factor),
                                   model.inputs, model.output);
  if (signals.output().unit != "N") {
    throw ConfigError(arguments.model.string(),
                      fmt::format("a model of {} [{}]", model.output, signals.output().unit),
                      "one of a force in N, which the motor takes away");
  }
  ControlOptions options;
  options.lead_s = 1e-3 * arguments.lead_ms;
  ConvertedModel control = to_control_model(carried, signals, options);
  if (!arguments.as_it_is) control.model.adapts = average_hand();
  cancellation::require_sound(control.model, canceller, arguments.model.string());
  files.set("--save", cancellation::control_model_json(control.model, arguments.rig));
  if (!arguments.json.empty()) files.set_json("--json", summary_of(control));
  files.publish();
  std::printf("%s at 1 kHz, off by at most %.2g %% from %g to %g Hz, in %s\n",
              arguments.model.string().c_str(), 100.0 * control.conversion_error, options.low_hz,
              options.high_hz, arguments.save.string().c_str());
  for (const Treatment& each : control.treatments) {
    std::printf("%s: %s: %s%s\n", each.kind.c_str(), each.cancelled ? "cancelled" : "left alone",
                each.how.c_str(), difference_of(each).c_str());
  }
  report::say_next("stillhand lab --conditions A,B,C --model " +
                   report::quoted_for_shell(arguments.save) + " --out run2");
  return 0;
}

}  // namespace

void add_control_model_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<ControlModelArguments>();
  lab::LabOptions places;
  lab::set_places(places);
  arguments->config = places.config;
  command_line::Command verb = cli.add_subcommand(
      "control-model",
      "Converts a model that `stillhand diagnose --save` wrote to the canceller's 1 kHz, for\n"
      "`stillhand lab --model`, and prints for each effect what the motor will do about it.\n"
      "The converted effect runs next to the diagnosed one, over REC and over another motion of "
      "the\n"
      "same spectrum: where the forces differ by more than 1 %, the effect is left alone.\n"
      "REC is the recording that was diagnosed: its ranges are those of the model's tables.\n"
      "Example: stillhand control-model model.json run1/session.mcap --trial I --save "
      "control.json");
  verb.add_option("MODEL", arguments->model, "model file").required();
  measurement::add_recording_options(verb, arguments->recording, arguments->read);
  verb.add_option("--save", arguments->save, "file of the control model")
      .required()
      .check(settings::check_name);
  verb.add_option("--json", arguments->json,
                  "file of what becomes of each effect, with the difference of its force")
      .check(settings::check_name);
  verb.add_option("--rig", arguments->rig, "number of the rig that the model is for");
  verb.add_option("--lead-ms", arguments->lead_ms,
                  "delay of the motor [ms]; the model predicts this time ahead")
      .check(settings::number_between(0.0, 100.0));
  verb.add_flag("--as-it-is", arguments->as_it_is, "gain and phase do not adapt while it runs");
  verb.add_option("--config", arguments->config,
                  "folder with the settings of each service: the canceller's bounds");
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::close_the_loop
