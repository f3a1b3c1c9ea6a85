// SPDX-License-Identifier: Apache-2.0
#include "services/files/diagnosis/model_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::diagnosis {
namespace {

using Json = settings::JsonEntry::Json;
using Entry = settings::JsonEntry;

// The name that the first files carry.
constexpr const char* kFormat = "stillhand augmented model";
constexpr std::size_t kMostOrder = 12;
constexpr std::size_t kMostInputs = 16;
constexpr std::size_t kMostEffects = 16;
constexpr std::size_t kMostNumbers = 200;
constexpr const char* kReadByForm = "the channels and parameters that its kind and form read";

Json json_of(const SeenRange& range) {
  return {{"of", range.of}, {"unit", range.unit}, {"low", range.low}, {"high", range.high}};
}

Json json_of(const std::vector<SeenRange>& ranges) {
  Json all = Json::array();
  for (const SeenRange& range : ranges) all.push_back(json_of(range));
  return all;
}

Json json_of(const std::vector<ExcitedBand>& bands) {
  Json all = Json::array();
  for (const ExcitedBand& band : bands) {
    all.push_back({{"of", band.of}, {"low_hz", band.low_hz}, {"high_hz", band.high_hz}});
  }
  return all;
}

Json json_of(const Body& body) {
  return {
      {"numerators", body.numerators}, {"denominator", body.denominator}, {"offset", body.offset}};
}

Json json_of(const Effect& effect) {
  Json parameters = Json::array();
  for (const Parameter& p : effect.parameters) {
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"value", p.value},
                          {"lower", p.lower},
                          {"upper", p.upper},
                          {"fitted", p.fitted}});
  }
  Json json{{"kind", effect.kind},
            {"form", effect.form},
            {"channels", effect.channels},
            {"parameters", parameters},
            {"coefficients", effect.coefficients}};
  if (!effect.seen.empty()) json["seen"] = json_of(effect.seen);
  if (!effect.is_whole()) json["share"] = effect.share;
  return json;
}

Json json_of(const std::vector<Effect>& effects) {
  Json all = Json::array();
  for (const Effect& effect : effects) all.push_back(json_of(effect));
  return all;
}

Json json_of(const CarriedModel& carried) {
  Json left_out = Json::array();
  for (const LeftOut& each : carried.left_out) {
    left_out.push_back({{"kind", each.effect.kind},
                        {"form", each.effect.form},
                        {"channels", each.effect.channels},
                        {"why", each.why}});
  }
  return {{"body", json_of(carried.model.body)},       {"heldout_rmse", carried.model.heldout_rmse},
          {"effects", json_of(carried.model.effects)}, {"inputs", json_of(carried.inputs)},
          {"bands", json_of(carried.bands)},           {"left_out", left_out},
          {"stability", name_of(carried.stability)}};
}

Json json_of(const Model& model) {
  return {{"format", kFormat},           {"version", kModelFormatVersion},
          {"rate_hz", model.rate_hz},    {"inputs", model.inputs},
          {"output", model.output},      {"output_unit", model.output_unit},
          {"body", json_of(model.body)}, {"effects", json_of(model.effects)}};
}

std::vector<SeenRange> ranges_of(const Entry& entry, std::size_t most) {
  std::vector<SeenRange> ranges;
  for (const Entry& each : entry.entries(0, most)) {
    SeenRange range{each.at("of").text(), each.at("unit").text(), each.at("low").number(),
                    each.at("high").number()};
    if (range.low > range.high) each.at("high").refuse("a number from low on");
    ranges.push_back(std::move(range));
  }
  return ranges;
}

std::vector<ExcitedBand> bands_of(const Entry& entry) {
  std::vector<ExcitedBand> bands;
  for (const Entry& each : entry.entries(0, kMostInputs)) {
    ExcitedBand band{each.at("of").text(), each.at("low_hz").number(), each.at("high_hz").number()};
    if (band.low_hz > band.high_hz) each.at("high_hz").refuse("a number from low_hz on");
    bands.push_back(std::move(band));
  }
  return bands;
}

Parameter parameter_of(const Entry& entry) {
  Parameter parameter{entry.at("name").text(),    entry.at("unit").text(),
                      entry.at("value").number(), entry.at("lower").number(),
                      entry.at("upper").number(), entry.at("fitted").boolean()};
  if (parameter.value < parameter.lower || parameter.value > parameter.upper) {
    entry.at("value").refuse("a number from lower to upper");
  }
  return parameter;
}

Effect effect_of(const Entry& entry, std::size_t order) {
  Effect effect;
  effect.kind = entry.at("kind").text();
  const auto& kinds = effect_kinds();
  const auto known = std::ranges::find_if(
      kinds, [&](const EffectKind* kind) { return kind->name() == effect.kind; });
  if (known == kinds.end()) entry.at("kind").refuse("a kind that this version knows");
  effect.form = entry.at("form").text();
  for (const Entry& channel : entry.at("channels").entries(0, 2)) {
    effect.channels.push_back(channel.text());
  }
  for (const Entry& parameter : entry.at("parameters").entries(0, kMostNumbers)) {
    effect.parameters.push_back(parameter_of(parameter));
  }
  effect.coefficients = entry.at("coefficients").numbers(0, kMostNumbers);
  if (entry.has("seen")) effect.seen = ranges_of(entry.at("seen"), 2);
  if (entry.has("share")) {
    effect.share = entry.at("share").number();
    if (!(effect.share > 0.0 && effect.share <= 1.0)) {
      entry.at("share").refuse("a number above 0, at most 1");
    }
  }
  try {
    if ((*known)->stage(effect) == Stage::kFeedback &&
        !fits_loop(effect.coefficients.size(), (*known)->feedback(effect), order)) {
      entry.at("coefficients").refuse("as many as the body's order asks for");
    }
  } catch (const std::out_of_range&) {
    entry.refuse(kReadByForm);
  }
  return effect;
}

// Some samples of every channel that the model reads: enough to ask a kind what it needs.
Signals made_up_signals(const Model& model) {
  constexpr std::size_t kSamples = 64;
  Measurement made;
  made.source = "model";
  made.rate_hz = model.rate_hz;
  made.stretches = {{0, kSamples, 0.0}};
  made.weight.assign(kSamples, 1.0);
  const auto add = [&](const std::string& name) {
    if (made.find(name) != nullptr) return;
    const double step = 1.0 + 0.3 * static_cast<double>(made.channels.size());
    Channel channel{name, "", std::vector<double>(kSamples)};
    for (std::size_t n = 0; n < kSamples; ++n) {
      channel.values[n] = std::sin(step * static_cast<double>(n));
    }
    made.channels.push_back(std::move(channel));
  };
  add(model.output);
  for (const std::string& input : model.inputs) add(input);
  for (const Effect& effect : model.effects) {
    for (const std::string& channel : effect.channels) add(channel);
  }
  return {made, model.inputs, model.output};
}

// Linear numbers that the prediction takes; a feedback's were counted when they were read.
// @throws std::out_of_range for an effect without the channels or parameters that its kind reads.
std::size_t coefficients_of(const Effect& effect, const Model& model, const Signals& signals) {
  const EffectKind& kind = effect_kind(effect.kind);
  if (kind.stage(effect) == Stage::kFeedback) return effect.coefficients.size();
  if (kind.stage(effect) != Stage::kTerm) return 0;
  Columns columns;
  kind.terms(effect, signals, std::vector<double>(signals.size(), 0.0), columns);
  return columns.size() * (kind.through_body(effect) ? model.body.order() + 1 : 1);
}

// What no single entry shows: whether the effects have all that their kinds and forms read.
void check_effects(const Model& model, const std::vector<Entry>& entries) {
  const Signals signals = made_up_signals(model);
  int feedbacks = 0;
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    const Effect& effect = model.effects[i];
    try {
      if (acts_at(effect, Stage::kFeedback) && ++feedbacks > 1) {
        entries[i].refuse("one effect inside of the body at a time");
      }
      const std::size_t count = coefficients_of(effect, model, signals);
      if (effect.coefficients.size() != count) {
        entries[i].at("coefficients").refuse(std::to_string(count) + " numbers for this form");
      }
      Model alone = model;
      alone.effects = {effect};
      static_cast<void>(free_run(alone, signals));
      static_cast<void>(effect_kind(effect.kind).time_only(effect));
    } catch (const std::out_of_range&) {
      entries[i].refuse(kReadByForm);
    }
  }
}

Body body_of(const Entry& entry) {
  Body body;
  body.largest_radius = 1.0;  // the fit's own bound depended on the record's length
  body.denominator = entry.at("denominator").numbers(1, kMostOrder + 1);
  for (const Entry& numerator : entry.at("numerators").entries(1, kMostInputs)) {
    body.numerators.push_back(numerator.numbers(1, kMostOrder + 1));
    if (body.numerators.back().size() != body.denominator.size()) {
      numerator.refuse(std::to_string(body.denominator.size()) + " numbers as the denominator");
    }
  }
  body.offset = entry.at("offset").number();
  if (body.denominator.front() != 1.0) entry.at("denominator").refuse("1 first");
  if (!is_stable(body)) entry.at("denominator").refuse("every pole inside the unit circle");
  return body;
}

// Since 2026-11-27.
double heldout_rmse_of(const Entry& entry) {
  if (!entry.has("heldout_rmse")) return 0.0;
  const double rmse = entry.at("heldout_rmse").number();
  if (rmse < 0.0) entry.at("heldout_rmse").refuse("a number from 0 on");
  return rmse;
}

// Body and effects.
void read_parts(const Entry& entry, Model& model) {
  model.body = body_of(entry.at("body"));
  if (model.body.numerators.size() != model.inputs.size()) {
    entry.at("body").at("numerators").refuse("one an input");
  }
  const std::vector<Entry> effects = entry.at("effects").entries(0, kMostEffects);
  for (const Entry& effect : effects) {
    model.effects.push_back(effect_of(effect, model.body.order()));
  }
  check_effects(model, effects);
}

}  // namespace

std::string model_json(const Model& model) {
  std::string text = json_of(model).dump(2) + "\n";
  // A number that isn't finite would be written as null: what can't be read isn't written.
  static_cast<void>(parse_model(text, "model"));
  return text;
}

std::string model_json(const Model& found, const CarriedModel& carried) {
  Json json = json_of(found);
  json["carried"] = json_of(carried);
  json["in_session"] = {{"body", json_of(carried.in_session.body)},
                        {"effects", json_of(carried.in_session.effects)}};
  std::string text = json.dump(2) + "\n";
  static_cast<void>(parse_carried_model(text, "model"));
  return text;
}

std::string model_json(const Model& found, const CarriedModel& carried, const Model& linear) {
  Json json = Json::parse(model_json(found, carried));
  json["linear"] = {{"body", json_of(linear.body)}, {"heldout_rmse", linear.heldout_rmse}};
  std::string text = json.dump(2) + "\n";
  static_cast<void>(parse_linear_model(text, "model"));
  return text;
}

Model parse_model(std::string_view json, const std::string& origin) {
  const Json whole = settings::parsed_json(
      json, origin, "JSON of a diagnosed model, as `stillhand diagnose --save` writes");
  const Entry top(whole, origin);
  if (top.at("format").text() != kFormat) {
    top.at("format").refuse(
        "\"stillhand augmented model\", as `stillhand diagnose --save` writes (that of `stillhand "
        "identify --save` is for the canceller)");
  }
  const auto version = top.at("version").count();
  if (version < 1 || version > kModelFormatVersion) {
    top.at("version").refuse("1 or 2: a newer stillhand wrote this file");
  }
  Model model;
  model.rate_hz = top.at("rate_hz").number();
  if (!(model.rate_hz > 0.0)) top.at("rate_hz").refuse("a number above 0");
  for (const Entry& input : top.at("inputs").entries(1, kMostInputs)) {
    model.inputs.push_back(input.text());
  }
  model.output = top.at("output").text();
  model.output_unit = top.at("output_unit").text();
  read_parts(top, model);
  return model;
}

CarriedModel parse_carried_model(std::string_view json, const std::string& origin) {
  Model found = parse_model(json, origin);
  const Json whole = settings::parsed_json(json, origin, "JSON of a diagnosed model");
  const Entry top(whole, origin);
  if (!top.has("carried")) return carried_as_it_is(std::move(found));
  const Entry entry = top.at("carried");
  CarriedModel carried = carried_as_it_is(std::move(found));
  const auto read_model = [](const Entry& from, Model& model) {
    model.effects.clear();
    read_parts(from, model);
  };
  read_model(entry, carried.model);
  carried.model.heldout_rmse = heldout_rmse_of(entry);
  carried.in_session = carried.model;
  if (top.has("in_session")) read_model(top.at("in_session"), carried.in_session);
  carried.inputs = ranges_of(entry.at("inputs"), kMostInputs);
  if (entry.has("bands")) carried.bands = bands_of(entry.at("bands"));  // since 2026-11-24
  for (const Entry& each : entry.at("left_out").entries(0, kMostEffects)) {
    LeftOut left;
    left.effect.kind = each.at("kind").text();
    left.effect.form = each.at("form").text();
    left.why = each.at("why").text();
    for (const Entry& channel : each.at("channels").entries(0, 2)) {
      left.effect.channels.push_back(channel.text());
    }
    carried.left_out.push_back(std::move(left));
  }
  const std::string stability = entry.at("stability").text();
  if (stability != name_of(Stability::kProved) && stability != name_of(Stability::kTested)) {
    entry.at("stability").refuse("proved or tested");
  }
  if (stability == name_of(Stability::kTested)) carried.stability = Stability::kTested;
  return carried;
}

std::optional<Model> parse_linear_model(std::string_view json, const std::string& origin) {
  Model linear = parse_model(json, origin);
  const Json whole = settings::parsed_json(json, origin, "JSON of a diagnosed model");
  const Entry top(whole, origin);
  if (!top.has("linear")) return {};
  linear.effects.clear();
  linear.body = body_of(top.at("linear").at("body"));
  linear.heldout_rmse = heldout_rmse_of(top.at("linear"));
  if (linear.body.numerators.size() != linear.inputs.size()) {
    top.at("linear").at("body").at("numerators").refuse("one an input");
  }
  return linear;
}

}  // namespace stillhand::diagnosis
