// SPDX-License-Identifier: Apache-2.0
// A control model as a file: what was written is read back bit for bit, and what was tampered with
// is refused by name.
#include "services/files/cancellation/control_model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/refusal.hpp"

namespace stillhand::cancellation::control_model_file_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

// Something in every part.
ControlModel full_model() {
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, -1.99, 0.9902};
  const ValueMap map{-2.0, 2.0, {-1.0 / 3.0, 0.0, 0.1}};
  model.inputs = {{Channel::kAccelY, map, {0.0, 2e-4, 1e-5}},
                  {Channel::kRoll, {}, {1e-4, 0.0, 0.0}}};
  model.loop = LoopPath{{0.1, 0.2, 0.3}, {0.0, 1e-4, 0.0}, {0.0, 1e-5, 0.0}, map, 10};
  model.output = map;
  model.paths = {{Channel::kOmega, 0.05, map, -0.8}};
  model.waves = {{Channel::kTheta, 12.0, 0.1, 0.2}, {std::nullopt, 9.3, 0.3, 0.4}};
  model.hysteresis = {{std::nullopt, signal::HysteresisOperator::kStop, 1.0 / 3.0, -0.7, 0.8},
                      {0, signal::HysteresisOperator::kDahl, 0.2, -15.0, 15.0}};
  model.adapts = HandCompliance{1.4, 30.0, 900.0, 0.09};
  return model;
}

std::string refusal(const std::string& text, std::uint32_t rig = 1) {
  return support::refusal([&] { parse_control_model(text, "m.json", rig); });
}

std::string changed(const std::function<void(Json&)>& change) {
  Json json = Json::parse(control_model_json(full_model(), 1));
  change(json);
  return json.dump();
}

TEST(ControlModelFileTest, EveryNumberIsReadBackAsItWasWritten) {
  const std::string text = control_model_json(full_model(), 7);
  const ControlModel back = parse_control_model(text, "m.json", 7);
  EXPECT_EQ(control_model_json(back, 7), text);
  EXPECT_EQ(back.inputs[0].map.values, full_model().inputs[0].map.values);
  EXPECT_EQ(back.loop->e, full_model().loop->e);
  EXPECT_EQ(back.loop->ticks, 10);
  EXPECT_EQ(back.paths[0].channel, Channel::kOmega);
  EXPECT_EQ(back.waves[0].channel, Channel::kTheta);
  EXPECT_FALSE(back.waves[1].channel);
  ASSERT_EQ(back.hysteresis.size(), 2u);
  EXPECT_FALSE(back.hysteresis[0].path);
  EXPECT_EQ(back.hysteresis[0].threshold, 1.0 / 3.0);
  EXPECT_EQ(back.hysteresis[1].path, 0u);
  EXPECT_EQ(back.hysteresis[1].operation, signal::HysteresisOperator::kDahl);
  EXPECT_EQ(back.adapts->lever_m, 0.09);
}

TEST(ControlModelFileTest, ThePapersModelNeedsNoneOfTheParts) {
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0};
  model.inputs = {{Channel::kAccelY, {}, {3.2}}};
  const ControlModel back = parse_control_model(control_model_json(model, 1), "m.json", 1);
  EXPECT_FALSE(back.loop);
  EXPECT_FALSE(back.adapts);
  EXPECT_TRUE(back.output.values.empty());
}

TEST(ControlModelFileTest, AnotherRigANewerVersionAndAForgedLimitAreRefusedByName) {
  const std::string text = control_model_json(full_model(), 1);
  EXPECT_THAT(refusal(text, 2), AllOf(HasSubstr("m.json.rig"), HasSubstr("rig 2")));
  EXPECT_THAT(refusal(changed([](Json& json) { json["version"] = 3; })),
              AllOf(HasSubstr("m.json.version"), HasSubstr("newer")));
  EXPECT_THAT(refusal(changed([](Json& json) { json["max_force_n"] = 60.0; })),
              HasSubstr("m.json.max_force_n"));
  EXPECT_THAT(refusal(changed([](Json& json) { json["adapts"]["max_gain"] = 9.0; })),
              HasSubstr("m.json.adapts.max_gain"));
}

// Version 1 had no elements with memory, and a spring that takes a value at each tick.
TEST(ControlModelFileTest, AFileOfTheFirstVersionIsStillRead) {
  const std::string first = changed([](Json& json) {
    json["version"] = 1;
    json.erase("hysteresis");
    json["loop"].erase("ticks");
  });
  const ControlModel back = parse_control_model(first, "m.json", 1);
  EXPECT_TRUE(back.hysteresis.empty());
  EXPECT_EQ(back.loop->ticks, 1);
  EXPECT_EQ(back.paths[0].gain, -0.8);
  EXPECT_THAT(refusal(changed([](Json& json) { json.erase("hysteresis"); })),
              HasSubstr("m.json.hysteresis"));
}

TEST(ControlModelFileTest, WhatHasTheWrongShapeIsRefusedByName) {
  EXPECT_THAT(refusal("{"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("[]"), HasSubstr("m.json"));
  std::string twice = control_model_json(full_model(), 1);
  twice.insert(twice.find("\"rig\""), "\"rig\": 2, ");
  EXPECT_THAT(refusal(twice), AllOf(HasSubstr("rig"), HasSubstr("twice")));
  EXPECT_THAT(refusal(changed([](Json& json) { json["inputs"][1].erase("numerator"); })),
              HasSubstr("m.json.inputs[1].numerator"));
  EXPECT_THAT(refusal(changed([](Json& json) { json["inputs"][0]["channel"] = "a_q"; })),
              AllOf(HasSubstr("m.json.inputs[0].channel"), HasSubstr("a_q")));
  const struct {
    const char* at;
    Json value;
    const char* named;
  } cases[] = {{"/paths/0/lag_s", -0.1, "paths[0].lag_s"},
               {"/output/low", 3.0, "output.high"},
               {"/format", "stillhand model", "format"},
               {"/waves/1/sine_n", nullptr, "waves[1].sine_n"},
               {"/hysteresis/0/operator", "play", "hysteresis[0].operator"},
               {"/hysteresis/1/threshold", 0.0, "hysteresis[1].threshold"},
               {"/loop/ticks", 0, "loop.ticks"},
               {"/hysteresis/1/low", 15.0, "hysteresis[1].high"},
               {"/denominator", Json::array(), "denominator"},
               {"/output/values", std::vector<double>(100'000, 0.0), "output.values"}};
  for (const auto& each : cases) {
    const auto set = [&](Json& json) { json[Json::json_pointer(each.at)] = each.value; };
    EXPECT_THAT(refusal(changed(set)), HasSubstr(std::string("m.json.") + each.named)) << each.at;
  }
}

TEST(ControlModelFileTest, WhatTheCancellerWouldRefuseIsSaid) {
  const Config settings;
  const auto why = [&](const ControlModel& model) {
    return support::refusal([&] { require_sound(model, settings, "m.json"); });
  };
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, -1.99, 0.9902};
  model.inputs = {{Channel::kAccelY, {}, {0.0, 2e-4, 0.0}}};
  EXPECT_EQ(why(model), "accepted");
  ControlModel unstable = model;
  unstable.denominator = {1.0, -2.02, 1.03};
  EXPECT_THAT(why(unstable), AllOf(HasSubstr("m.json"), HasSubstr("unit circle")));
  ControlModel strong = model;
  strong.inputs[0].numerator[1] = 1.0;
  EXPECT_THAT(why(strong), HasSubstr("gain"));
}

}  // namespace
}  // namespace stillhand::cancellation::control_model_file_test
