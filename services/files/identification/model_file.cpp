// SPDX-License-Identifier: Apache-2.0
#include "services/files/identification/model_file.hpp"

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::identification {
namespace {

using Json = settings::JsonEntry::Json;
constexpr const char* kFormat = "stillhand model";
constexpr std::size_t kMostCoefficients = 13;

void check(const DifferenceModel& model, const std::string& path) {
  if (model.numerator.size() != model.denominator.size()) {
    throw ConfigError(path + ".denominator", std::to_string(model.denominator.size()) + " numbers",
                      std::to_string(model.numerator.size()) + ", as many as in the numerator");
  }
  if (!signal::well_formed(model)) {
    throw ConfigError(path, "a malformed model",
                      "a rate above 0 and finite coefficients, the denominator's first 1");
  }
  if (!signal::is_stable(model)) {
    throw ConfigError(path, "an unstable model", "every pole inside the unit circle");
  }
}

Json json_of(const DifferenceModel& model) {
  return {{"rate_hz", model.rate_hz},
          {"numerator", model.numerator},
          {"denominator", model.denominator}};
}

DifferenceModel model_of(const settings::JsonEntry& entry) {
  DifferenceModel model{entry.at("rate_hz").number(),
                        entry.at("numerator").numbers(1, kMostCoefficients),
                        entry.at("denominator").numbers(1, kMostCoefficients)};
  return model;
}

void check(const FeedthroughModel& model, const std::string& origin) {
  check(model.fit, origin + ".fit");
  check(model.control, origin + ".control");
  if (model.control.rate_hz != kControlRateHz) {
    throw ConfigError(origin + ".control.rate_hz", std::to_string(model.control.rate_hz),
                      "1000, the control rate");
  }
}

FitQuality quality_of(const settings::JsonEntry& entry) {
  FitQuality quality;
  quality.one_step_rms_n = entry.at("one_step_rms_n").number();
  quality.one_step_vaf_percent = entry.at("one_step_vaf_percent").number();
  quality.free_run_rms_n = entry.at("free_run_rms_n").number();
  quality.free_run_vaf_percent = entry.at("free_run_vaf_percent").number();
  quality.samples = entry.at("samples").count();
  return quality;
}

}  // namespace

std::string model_json(const FeedthroughModel& model) {
  const FitQuality& q = model.heldout;
  const Json json{{"format", kFormat},
                  {"version", kModelFormatVersion},
                  {"fit", json_of(model.fit)},
                  {"control", json_of(model.control)},
                  {"heldout",
                   {{"one_step_rms_n", q.one_step_rms_n},
                    {"one_step_vaf_percent", q.one_step_vaf_percent},
                    {"free_run_rms_n", q.free_run_rms_n},
                    {"free_run_vaf_percent", q.free_run_vaf_percent},
                    {"samples", q.samples}}},
                  {"condition_number", model.condition_number},
                  {"conversion_error", model.conversion_error},
                  {"refined", model.refined}};
  std::string text = json.dump(2) + "\n";
  // A number that isn't finite would be written as null: what can't be read isn't written.
  static_cast<void>(parse_model(text, "model"));
  return text;
}

FeedthroughModel parse_model(std::string_view json, const std::string& origin) {
  const Json whole = settings::parsed_json(json, origin, "JSON of a stillhand model");
  const settings::JsonEntry top(whole, origin);
  if (top.at("format").text() != kFormat) top.at("format").refuse("\"stillhand model\"");
  if (top.at("version").count() != kModelFormatVersion) {
    top.at("version").refuse("1: a newer stillhand wrote this file");
  }
  FeedthroughModel model;
  model.fit = model_of(top.at("fit"));
  model.control = model_of(top.at("control"));
  model.heldout = quality_of(top.at("heldout"));
  model.condition_number = top.at("condition_number").number();
  model.conversion_error = top.at("conversion_error").number();
  model.refined = top.at("refined").boolean();
  check(model, origin);
  return model;
}

}  // namespace stillhand::identification
