// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::diagnosis::diagnosed_model_file_test {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

Effect path_from_roll() { return {"coupled_input", "static", {"roll"}, {}, {12.0}}; }

Effect tone() {
  return {"tone", "fixed", {}, {{"frequency", "Hz", 3.0, 1.0, 5.0, true}}, {0.5, -0.2}};
}

Effect friction() { return {"coulomb_friction", "sign", {"rate of theta"}, {}, {-0.4}}; }

Model model_with(Effect effect) {
  Model model;
  model.rate_hz = 100.0;
  model.inputs = {"a_y"};
  model.output = "f";
  model.output_unit = "N";
  model.body.numerators = {{-3.0, 0.5, 0.1}};
  model.body.denominator = {1.0, -0.9, 0.2};
  model.effects = {std::move(effect)};
  return model;
}

std::string refusal(const std::string& text) {
  return support::refusal([&] { static_cast<void>(parse_model(text, "m.json")); });
}

// The first effect of a good file, changed.
template <typename Change>
std::string changed(const Effect& effect, const Change& change) {
  json file = json::parse(model_json(model_with(effect)));
  change(file["effects"][0]);
  return file.dump();
}

TEST(DiagnosedModelFileTest, EffectsComeBackAsTheyWere) {
  for (const Effect& effect : {path_from_roll(), tone(), friction()}) {
    const Model sut = parse_model(model_json(model_with(effect)), "m.json");
    ASSERT_EQ(sut.effects.size(), 1u) << effect.kind;
    EXPECT_EQ(sut.effects[0].coefficients, effect.coefficients) << effect.kind;
    EXPECT_EQ(sut.effects[0].channels, effect.channels) << effect.kind;
  }
}

TEST(DiagnosedModelFileTest, AWrongNumberOfCoefficientsIsNamed) {
  for (const Effect& effect : {path_from_roll(), tone(), friction()}) {
    const std::string want = std::to_string(effect.coefficients.size()) + " numbers";
    const auto fewer = [](json& entry) { entry["coefficients"].erase(0); };
    const auto more = [](json& entry) { entry["coefficients"].push_back(1.0); };
    EXPECT_THAT(refusal(changed(effect, fewer)), AllOf(HasSubstr("m.json"), HasSubstr(want)))
        << effect.kind;
    EXPECT_THAT(refusal(changed(effect, more)), AllOf(HasSubstr("coefficients"), HasSubstr(want)))
        << effect.kind;
  }
}

TEST(DiagnosedModelFileTest, APathThroughTheBodyHasOneMoreThanItsOrder) {
  Effect through = path_from_roll();
  through.form = "through the body";
  through.coefficients = {1.0, 2.0, 3.0};
  EXPECT_EQ(refusal(model_json(model_with(through))), "accepted");
  const auto one = [](json& entry) { entry["coefficients"] = {1.0}; };
  EXPECT_THAT(refusal(changed(through, one)), HasSubstr("3 numbers"));
}

TEST(DiagnosedModelFileTest, MissingChannelsAndParametersAreRefused) {
  const auto no_channel = [](json& entry) { entry["channels"] = json::array(); };
  const auto no_parameter = [](json& entry) { entry["parameters"] = json::array(); };
  EXPECT_THAT(refusal(changed(friction(), no_channel)),
              AllOf(HasSubstr("effects"), HasSubstr("channels and parameters")));
  EXPECT_THAT(refusal(changed(tone(), no_parameter)),
              AllOf(HasSubstr("effects"), HasSubstr("channels and parameters")));
}

CarriedModel carried_path() {
  CarriedModel carried = carried_as_it_is(model_with(path_from_roll()));
  carried.model.effects[0].seen = {{"roll", "rad", -0.125, 0.1}};
  carried.model.body.offset = 1.0 / 3.0;
  carried.inputs = {{"a_y", "m/s^2", -4.0, 5.0}};
  carried.bands = {{"a_y", 0.7, 2.0}};
  carried.left_out.push_back({{"tone", "fixed", {}, {}, {}}, "the inputs do not determine it"});
  carried.stability = Stability::kTested;
  return carried;
}

TEST(DiagnosedModelFileTest, WhatIsCarriedComesBackNextToWhatWasFound) {
  const std::string text = model_json(model_with(tone()), carried_path());
  EXPECT_EQ(parse_model(text, "m.json").effects.at(0).kind, "tone");
  const CarriedModel sut = parse_carried_model(text, "m.json");
  EXPECT_EQ(sut.model.effects.at(0).kind, "coupled_input");
  EXPECT_EQ(sut.model.body.offset, 1.0 / 3.0);
  ASSERT_EQ(sut.model.effects[0].seen.size(), 1u);
  EXPECT_EQ(sut.model.effects[0].seen[0].of, "roll");
  EXPECT_EQ(sut.model.effects[0].seen[0].low, -0.125);
  EXPECT_EQ(sut.inputs.at(0).high, 5.0);
  EXPECT_EQ(sut.bands.at(0).of, "a_y");
  EXPECT_EQ(sut.bands.at(0).low_hz, 0.7);
  EXPECT_EQ(sut.bands.at(0).high_hz, 2.0);
  EXPECT_EQ(sut.left_out.at(0).why, "the inputs do not determine it");
  EXPECT_EQ(sut.stability, Stability::kTested);
}

TEST(DiagnosedModelFileTest, AFileOfAnOlderVersionIsCarriedAsItIs) {
  const CarriedModel sut = parse_carried_model(model_json(model_with(tone())), "m.json");
  EXPECT_EQ(sut.model.effects.at(0).kind, "tone");
  EXPECT_TRUE(sut.model.effects[0].seen.empty());
  EXPECT_TRUE(sut.left_out.empty());
}

TEST(DiagnosedModelFileTest, AWrongPartOfWhatIsCarriedIsNamed) {
  const auto refused = [](const auto& change) -> std::string {
    json file = json::parse(model_json(model_with(tone()), carried_path()));
    change(file["carried"]);
    return support::refusal([&] { (void)parse_carried_model(file.dump(), "m.json"); });
  };
  EXPECT_EQ(refused([](json&) {}), "accepted");
  EXPECT_THAT(refused([](json& entry) { entry["stability"] = "refused"; }),
              HasSubstr("proved or tested"));
  EXPECT_THAT(refused([](json& entry) { entry["effects"][0]["seen"][0]["low"] = 1.0; }),
              AllOf(HasSubstr("seen"), HasSubstr("from low on")));
  EXPECT_THAT(refused([](json& entry) { entry["body"]["denominator"] = {1.0, -2.0, 1.0}; }),
              HasSubstr("unit circle"));
  EXPECT_THAT(refused([](json& entry) { entry.erase("left_out"); }), HasSubstr("left_out"));
}

TEST(DiagnosedModelFileTest, TheLinearModelComesBackAndMayBeMissing) {
  Model linear = model_with(path_from_roll());
  linear.effects.clear();
  linear.body.numerators = {{-2.0, 0.25, 1.0 / 3.0}};
  const std::string text = model_json(model_with(path_from_roll()), carried_path(), linear);
  const auto sut = parse_linear_model(text, "m.json");
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(sut->body.numerators, linear.body.numerators);
  EXPECT_EQ(sut->output, "f");
  EXPECT_TRUE(sut->effects.empty());
  EXPECT_EQ(parse_carried_model(text, "m.json").inputs.size(), 1u);
  EXPECT_FALSE(parse_linear_model(model_json(model_with(path_from_roll())), "m.json").has_value());
  json file = json::parse(text);
  file["linear"]["body"]["numerators"] = json::array({{1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}});
  EXPECT_THROW(static_cast<void>(parse_linear_model(file.dump(), "m.json")), ConfigError);
}

}  // namespace stillhand::diagnosis::diagnosed_model_file_test
