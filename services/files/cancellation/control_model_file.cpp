// SPDX-License-Identifier: Apache-2.0
#include "services/files/cancellation/control_model_file.hpp"

#include <algorithm>
#include <array>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/value_table.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::cancellation {
namespace {

using Json = settings::JsonEntry::Json;
using Entry = settings::JsonEntry;

constexpr const char* kFormat = "stillhand control model";
constexpr std::size_t kMostNumbers = ControlModelFilter::kMaxOrder + 1;
// This bounds a file's size; check_model() refuses what the filter has no room for.
constexpr std::size_t kMostParts = 64;

std::string_view name_of(Channel channel) {
  return kChannelFacts[static_cast<std::size_t>(channel)].name;
}

Json json_of(const ValueMap& map) {
  if (map.values.empty()) return nullptr;
  return {{"low", map.low}, {"high", map.high}, {"values", map.values}};
}

ValueMap map_of(const Entry& entry) {
  if (entry.is_null()) return {};
  entry.allow_only({"low", "high", "values"});
  if (entry.at("high").number() <= entry.at("low").number()) {
    entry.at("high").refuse("a number above low");
  }
  return {entry.at("low").number(), entry.at("high").number(),
          entry.at("values").numbers(2, ValueTable::kMostValues)};
}

Channel channel_of(const Entry& entry) {
  const std::string name = entry.text();
  const auto* const fact = std::ranges::find(kChannelFacts, name, &ChannelFacts::name);
  if (fact == kChannelFacts.end()) entry.refuse("a_x, a_y, a_z, roll, theta or omega");
  return static_cast<Channel>(fact - kChannelFacts.begin());
}

Json json_of(const std::optional<LoopPath>& loop) {
  if (!loop) return nullptr;
  return {{"e", loop->e},
          {"n", loop->n},
          {"m", loop->m},
          {"phi", json_of(loop->phi)},
          {"ticks", loop->ticks}};
}

// Version 1 had no ticks: a value at each of them.
LoopPath loop_of(const Entry& entry) {
  entry.allow_only({"e", "n", "m", "phi", "ticks"});
  LoopPath loop{entry.at("e").numbers(1, kMostNumbers), entry.at("n").numbers(0, kMostNumbers),
                entry.at("m").numbers(0, kMostNumbers), map_of(entry.at("phi"))};
  if (!entry.has("ticks")) return loop;
  loop.ticks = entry.at("ticks").whole();
  if (loop.ticks < 1) entry.at("ticks").refuse("1 or more");
  return loop;
}

Json json_of(const std::optional<HandCompliance>& hand) {
  if (!hand) return nullptr;
  return {{"mass_kg", hand->mass_kg},
          {"damping_n_s_m", hand->damping_n_s_m},
          {"stiffness_n_m", hand->stiffness_n_m},
          {"lever_m", hand->lever_m}};
}

constexpr std::array kOperators{std::string_view("stop"), std::string_view("dahl")};

Json json_of(const std::vector<Hysteresis>& all) {
  Json list = Json::array();
  for (const Hysteresis& each : all) {
    list.push_back({{"path", each.path ? Json(*each.path) : Json(nullptr)},
                    {"operator", kOperators.at(static_cast<std::size_t>(each.operation))},
                    {"threshold", each.threshold},
                    {"low", each.low},
                    {"high", each.high}});
  }
  return list;
}

Hysteresis hysteresis_of(const Entry& entry) {
  entry.allow_only({"path", "operator", "threshold", "low", "high"});
  Hysteresis out;
  if (const Entry path = entry.at("path"); !path.is_null()) out.path = path.count();
  const auto* const found = std::ranges::find(kOperators, entry.at("operator").text());
  if (found == kOperators.end()) entry.at("operator").refuse("stop or dahl");
  out.operation = static_cast<signal::HysteresisOperator>(found - kOperators.begin());
  out.threshold = entry.at("threshold").number();
  if (!(out.threshold > 0.0)) entry.at("threshold").refuse("a number above 0");
  out.low = entry.at("low").number();
  out.high = entry.at("high").number();
  if (out.high <= out.low) entry.at("high").refuse("a number above low");
  return out;
}

HandCompliance hand_of(const Entry& entry) {
  entry.allow_only({"mass_kg", "damping_n_s_m", "stiffness_n_m", "lever_m"});
  return {entry.at("mass_kg").number(), entry.at("damping_n_s_m").number(),
          entry.at("stiffness_n_m").number(), entry.at("lever_m").number()};
}

}  // namespace

std::string control_model_json(const ControlModel& model, std::uint32_t rig) {
  Json inputs = Json::array();
  for (const InputPath& input : model.inputs) {
    inputs.push_back({{"channel", name_of(input.channel)},
                      {"map", json_of(input.map)},
                      {"numerator", input.numerator}});
  }
  Json paths = Json::array();
  for (const DirectPath& path : model.paths) {
    paths.push_back({{"channel", name_of(path.channel)},
                     {"lag_s", path.lag_s},
                     {"map", json_of(path.map)},
                     {"gain", path.gain}});
  }
  Json waves = Json::array();
  for (const Wave& wave : model.waves) {
    waves.push_back({{"channel", wave.channel ? Json(name_of(*wave.channel)) : Json(nullptr)},
                     {"frequency", wave.frequency},
                     {"sine_n", wave.sine_n},
                     {"cosine_n", wave.cosine_n}});
  }
  const Json json{{"format", kFormat},
                  {"version", kModelFormatVersion},
                  {"rig", rig},
                  {"rate_hz", model.rate_hz},
                  {"denominator", model.denominator},
                  {"inputs", inputs},
                  {"loop", json_of(model.loop)},
                  {"output", json_of(model.output)},
                  {"paths", paths},
                  {"waves", waves},
                  {"hysteresis", json_of(model.hysteresis)},
                  {"adapts", json_of(model.adapts)}};
  std::string text = json.dump(2) + "\n";
  // A number that is not finite would be written as null: nothing is written that cannot be read.
  static_cast<void>(parse_control_model(text, "model", rig));
  return text;
}

ControlModel parse_control_model(std::string_view json, const std::string& origin,
                                 std::uint32_t rig) {
  const Json whole = settings::parsed_json(json, origin, "JSON of a stillhand control model");
  const Entry top(whole, origin);
  if (top.at("format").text() != kFormat) {
    top.at("format").refuse(
        "\"stillhand control model\", as `stillhand control-model` and `stillhand close-the-loop` "
        "write");
  }
  const std::size_t version = top.at("version").count();
  if (version < 1 || version > kModelFormatVersion) {
    top.at("version").refuse("1 or 2: a newer stillhand wrote this file");
  }
  // A limit in the file has no effect: it is refused, so that nobody relies on it.
  top.allow_only({"format", "version", "rig", "rate_hz", "denominator", "inputs", "loop", "output",
                  "paths", "waves", "hysteresis", "adapts"});
  if (top.at("rig").count() != rig) {
    top.at("rig").refuse("rig " + std::to_string(rig) + ", which the model is wanted for");
  }
  ControlModel model;
  model.rate_hz = top.at("rate_hz").number();
  model.denominator = top.at("denominator").numbers(1, kMostNumbers);
  for (const Entry& input : top.at("inputs").entries(1, kMostParts)) {
    input.allow_only({"channel", "map", "numerator"});
    model.inputs.push_back({channel_of(input.at("channel")), map_of(input.at("map")),
                            input.at("numerator").numbers(1, kMostNumbers)});
  }
  if (const Entry loop = top.at("loop"); !loop.is_null()) model.loop = loop_of(loop);
  model.output = map_of(top.at("output"));
  for (const Entry& path : top.at("paths").entries(0, kMostParts)) {
    path.allow_only({"channel", "lag_s", "map", "gain"});
    if (path.at("lag_s").number() < 0.0) path.at("lag_s").refuse("0 or more");
    model.paths.push_back({channel_of(path.at("channel")), path.at("lag_s").number(),
                           map_of(path.at("map")), path.at("gain").number()});
  }
  for (const Entry& wave : top.at("waves").entries(0, kMostParts)) {
    wave.allow_only({"channel", "frequency", "sine_n", "cosine_n"});
    Wave& to = model.waves.emplace_back();
    if (const Entry channel = wave.at("channel"); !channel.is_null()) {
      to.channel = channel_of(channel);
    }
    to.frequency = wave.at("frequency").number();
    if (to.frequency < 0.0) wave.at("frequency").refuse("0 or more");
    to.sine_n = wave.at("sine_n").number();
    to.cosine_n = wave.at("cosine_n").number();
  }
  // Version 1 knew no element with memory.
  if (version > 1 || top.has("hysteresis")) {
    for (const Entry& each : top.at("hysteresis").entries(0, kMostParts)) {
      model.hysteresis.push_back(hysteresis_of(each));
    }
  }
  if (const Entry hand = top.at("adapts"); !hand.is_null()) model.adapts = hand_of(hand);
  return model;
}

void require_sound(const ControlModel& model, const Config& settings, const std::string& origin) {
  const Refusal refusal = check_model(model, bounds(settings)).refusal;
  if (refusal == Refusal::kNone) return;
  throw ConfigError(origin, std::string(describe(refusal)), "a model that the canceller takes");
}

}  // namespace stillhand::cancellation
