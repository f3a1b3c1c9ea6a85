// SPDX-License-Identifier: Apache-2.0
// The file of a diagnosed model: every kind comes back bit for bit, and a wrong entry is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "services/core/contract/config_error.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "tests/support/refusal.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::diagnosis::diagnosed_model_refusals_test {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

Model good_model() {
  const Effect path{"coupled_input", "static", {"a_x"}, {}, {0.2}};
  return {100.0, {"u"}, "y", "N", made::two_pole_body(), {path}};
}

std::string refusal(const std::string& text) {
  return support::refusal([&] { static_cast<void>(parse_model(text, "m.json")); });
}

std::string refusal_after(const std::function<void(json&)>& change) {
  Model model = good_model();
  model.effects = {
      {"tone", "beside the body", {}, {{"frequency", "Hz", 3.0, 1.0, 5.0}}, {0.5, 1.0}}};
  json file = json::parse(model_json(model));
  change(file);
  return refusal(file.dump());
}

void expect_same(const Effect& sut, const Effect& want) {
  SCOPED_TRACE(want.kind + ", " + want.form);
  EXPECT_EQ(sut.kind, want.kind);
  EXPECT_EQ(sut.form, want.form);
  EXPECT_EQ(sut.channels, want.channels);
  EXPECT_EQ(sut.coefficients, want.coefficients);
  ASSERT_EQ(sut.parameters.size(), want.parameters.size());
  for (std::size_t i = 0; i < want.parameters.size(); ++i) {
    EXPECT_EQ(sut.parameters[i].name, want.parameters[i].name);
    EXPECT_EQ(sut.parameters[i].unit, want.parameters[i].unit);
    EXPECT_EQ(sut.parameters[i].value, want.parameters[i].value);
    EXPECT_EQ(sut.parameters[i].lower, want.parameters[i].lower);
    EXPECT_EQ(sut.parameters[i].upper, want.parameters[i].upper);
    EXPECT_EQ(sut.parameters[i].fitted, want.parameters[i].fitted);
  }
}

TEST(DiagnosedModelRefusalsTest, EveryKindAndFormComesBackBitForBit) {
  for (const Effect& effect : made::every_effect()) {
    Model model = good_model();
    model.effects = {effect};
    const std::string text = model_json(model);
    const Model sut = parse_model(text, "m.json");
    ASSERT_EQ(sut.effects.size(), 1u);
    expect_same(sut.effects[0], effect);
    EXPECT_EQ(model_json(sut), text) << effect.kind << ": written again, the same text";
  }
}

// Doubles whose shortest text has 16 or 17 digits, from the smallest to the largest.
TEST(DiagnosedModelRefusalsTest, NumbersKeepEveryBit) {
  Model model = good_model();
  model.rate_hz = 100.0 / 3.0;
  model.effects.clear();
  model.body.offset = -0.0;
  model.body.numerators = {{0.1 + 0.2, std::numeric_limits<double>::denorm_min(), 1e300 / 7.0}};
  const Model sut = parse_model(model_json(model), "m.json");
  EXPECT_EQ(sut.rate_hz, model.rate_hz);
  EXPECT_TRUE(std::signbit(sut.body.offset));
  EXPECT_EQ(sut.body.numerators, model.body.numerators);
  EXPECT_EQ(sut.body.denominator, model.body.denominator);
  EXPECT_EQ(sut.output_unit, "N");
}

TEST(DiagnosedModelRefusalsTest, SeveralInputsAndTheirNamesComeBack) {
  Model model = good_model();
  model.inputs = {"a_y", "name with \"quotes\" and µ"};
  model.body.numerators.push_back({0.25, 0.5, 0.75});
  model.effects.clear();
  const Model sut = parse_model(model_json(model), "m.json");
  EXPECT_EQ(sut.inputs, model.inputs);
  EXPECT_EQ(sut.body.numerators, model.body.numerators);
}

TEST(DiagnosedModelRefusalsTest, ANumberThatIsNotFiniteIsNotWritten) {
  EXPECT_NO_THROW(static_cast<void>(model_json(good_model())));
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Model model = good_model();
    model.body.offset = wrong;
    EXPECT_THROW(model_json(model), ConfigError);
    model = good_model();
    model.effects[0].coefficients[0] = wrong;
    EXPECT_THROW(model_json(model), ConfigError);
  }
}

// METHOD.md: a model has one feedback at a time, and what runs it counts on that.
TEST(DiagnosedModelRefusalsTest, ASecondEffectInsideOfTheBodyIsRefused) {
  const Effect play{
      "dead_zone", "play of the output", {}, {{"threshold", "N", 1.0, 0.5, 2.0}}, {0.1, 0.0}};
  Model model = good_model();
  model.effects.push_back(play);
  json file = json::parse(model_json(model));
  EXPECT_EQ(refusal(file.dump()), "accepted");
  file["effects"].push_back(file["effects"].back());
  EXPECT_THAT(refusal(file.dump()),
              AllOf(StartsWith("m.json.effects[2]"), HasSubstr("one effect inside of the body")));
}

TEST(DiagnosedModelRefusalsTest, TextThatIsNoJsonIsRefusedWithItsFile) {
  for (const char* text : {"", "{", "[1, 2", "{\"format\": }", "nan"}) {
    EXPECT_THAT(refusal(text), StartsWith("m.json")) << text;
  }
  for (const char* text : {"[]", "3", "null", "\"text\"", "{}"}) {
    EXPECT_NE(refusal(text), "accepted") << text;
  }
}

TEST(DiagnosedModelRefusalsTest, AnotherFormatOrAVersionToComeIsRefused) {
  EXPECT_THAT(refusal_after([](json& file) { file["format"] = "something else"; }),
              AllOf(HasSubstr("format"), HasSubstr("something else")));
  EXPECT_THAT(refusal_after([](json& file) { file["version"] = 3; }),
              AllOf(HasSubstr("version"), HasSubstr("3")));
  EXPECT_THAT(refusal_after([](json& file) { file["version"] = -1; }), HasSubstr("version"));
  EXPECT_EQ(refusal_after([](json& file) { file["version"] = 1; }), "accepted");
}

TEST(DiagnosedModelRefusalsTest, EveryEntryIsNeeded) {
  const json whole = json::parse(model_json(good_model()));
  for (const auto& [key, value] : whole.items()) {
    json file = whole;
    file.erase(key);
    EXPECT_THAT(refusal(file.dump()), HasSubstr(key));
  }
  for (const char* key : {"numerators", "denominator", "offset"}) {
    EXPECT_THAT(refusal_after([&](json& file) { file["body"].erase(key); }), HasSubstr(key));
  }
  for (const char* key : {"kind", "form", "channels", "parameters", "coefficients"}) {
    EXPECT_THAT(refusal_after([&](json& file) { file["effects"][0].erase(key); }), HasSubstr(key));
  }
  for (const char* key : {"name", "unit", "value", "lower", "upper", "fitted"}) {
    EXPECT_THAT(refusal_after([&](json& file) { file["effects"][0]["parameters"][0].erase(key); }),
                HasSubstr(key));
  }
}

TEST(DiagnosedModelRefusalsTest, AnEntryOfTheWrongTypeIsNamed) {
  const json whole = json::parse(model_json(good_model()));
  for (const auto& [key, value] : whole.items()) {
    json file = whole;
    file[key] = json::object({{"x", 1}});
    EXPECT_THAT(refusal(file.dump()), HasSubstr(key));
    file[key] = nullptr;
    EXPECT_THAT(refusal(file.dump()), HasSubstr(key));
  }
}

TEST(DiagnosedModelRefusalsTest, ARateIsPositive) {
  for (const double rate_hz : {0.0, -100.0}) {
    EXPECT_THAT(refusal_after([&](json& file) { file["rate_hz"] = rate_hz; }),
                HasSubstr("rate_hz"));
  }
}

TEST(DiagnosedModelRefusalsTest, ABodyOfAnotherShapeIsRefused) {
  const auto body = [](const char* key, const json& value) {
    return refusal_after([&](json& file) { file["body"][key] = value; });
  };
  EXPECT_THAT(body("denominator", {1.0, -0.5}), HasSubstr("numerators"));
  EXPECT_THAT(body("denominator", {2.0, -0.5, 0.1}), HasSubstr("denominator"));
  EXPECT_THAT(body("denominator", json::array()), HasSubstr("denominator"));
  EXPECT_THAT(body("numerators", json::array()), HasSubstr("numerators"));
  EXPECT_THAT(body("numerators", {{1.0, 2.0, 3.0}, {1.0, 2.0, 3.0}}), HasSubstr("numerators"))
      << "two for one input";
  EXPECT_THAT(body("numerators", {{1.0, 2.0}}), AllOf(HasSubstr("numerators"), HasSubstr("3")));
}

// Poles at 0.5 and 2, on the circle, and just inside.
TEST(DiagnosedModelRefusalsTest, APoleOutsideTheCircleIsRefused) {
  const auto with = [](double a_1, double a_2) {
    return refusal_after([&](json& file) { file["body"]["denominator"] = {1.0, a_1, a_2}; });
  };
  EXPECT_THAT(with(-2.5, 1.0), AllOf(HasSubstr("denominator"), HasSubstr("pole")));
  EXPECT_THAT(with(0.0, 1.0), HasSubstr("denominator"));
  EXPECT_EQ(with(0.0, 0.998), "accepted");
}

TEST(DiagnosedModelRefusalsTest, AKindThatIsUnknownIsNamed) {
  EXPECT_THAT(refusal_after([](json& file) { file["effects"][0]["kind"] = "gremlins"; }),
              AllOf(HasSubstr("kind"), HasSubstr("gremlins")));
}

TEST(DiagnosedModelRefusalsTest, AParameterOutsideItsBoundsIsRefused) {
  const auto with = [](double value) {
    return refusal_after([&](json& file) { file["effects"][0]["parameters"][0]["value"] = value; });
  };
  EXPECT_THAT(with(5.5), HasSubstr("value"));
  EXPECT_THAT(with(0.5), HasSubstr("value"));
  EXPECT_EQ(with(5.0), "accepted");
  EXPECT_EQ(with(1.0), "accepted");
}

TEST(DiagnosedModelRefusalsTest, ALoopHasAsManyNumbersAsItsPlaceAsksFor) {
  const auto with = [](std::size_t count) {
    return refusal_after([&](json& file) {
      file["effects"][0] = {{"kind", "dead_zone"},
                            {"form", "play"},
                            {"channels", json::array()},
                            {"parameters", json::array()},
                            {"coefficients", std::vector<double>(count, 0.0)}};
    });
  };
  // Order 2: two of the output, eight inside.
  EXPECT_EQ(with(2), "accepted");
  EXPECT_EQ(with(8), "accepted");
  for (const std::size_t count : {0u, 1u, 3u, 7u, 9u}) {
    EXPECT_THAT(with(count), HasSubstr("coefficients")) << count;
  }
}

TEST(DiagnosedModelRefusalsTest, MoreThanAModelCanHoldIsRefused) {
  EXPECT_THAT(refusal_after([](json& file) {
                const json one = file["effects"][0];
                file["effects"] = std::vector<json>(17, one);
              }),
              HasSubstr("effects"));
  EXPECT_THAT(refusal_after([](json& file) { file["inputs"] = std::vector<std::string>(17, "u"); }),
              HasSubstr("inputs"));
  EXPECT_THAT(refusal_after([](json& file) { file["effects"][0]["channels"] = {"u", "v", "w"}; }),
              HasSubstr("channels"));
}

}  // namespace stillhand::diagnosis::diagnosed_model_refusals_test
