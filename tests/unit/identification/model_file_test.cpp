// SPDX-License-Identifier: Apache-2.0
#include "services/files/identification/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::identification::model_file_test {
namespace {

using ::testing::HasSubstr;

FeedthroughModel model() {
  FeedthroughModel out;
  out.fit = support::body_like_model();
  const auto conversion = to_control_rate(out.fit);
  out.control = conversion.model;
  out.conversion_error = conversion.max_error;
  out.heldout = {0.1, 99.5, 1.0 / 3.0, 98.7, 1500};
  out.condition_number = 1234.5;
  out.refined = true;
  return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
std::string refusal(const std::string& text) {
  return support::refusal([&] { parse_model(text, "m.json"); });
}

TEST(ModelFileTest, KeepsEveryBit) {
  const FeedthroughModel written = model();
  EXPECT_EQ(parse_model(model_json(written), "m.json"), written);
}

TEST(ModelFileTest, SyntaxErrorsNameTheLine) {
  EXPECT_THAT(refusal("{\n  \"format\": \"stillhand model\",\n  oops\n}"), HasSubstr("line 3"));
  EXPECT_THAT(refusal(""), HasSubstr("line 1"));
  EXPECT_THAT(refusal(model_json(model()).substr(0, 200)), HasSubstr("m.json"));
}

TEST(ModelFileTest, WrongEntriesAndCoefficientsThatMakeNoModelAreNamed) {
  const std::string good = model_json(model());
  const std::string fit_rate = "\"rate_hz\": 50.0";
  const struct {
    std::string from, to, said;
  } cases[] = {
      {"\"condition_number\"", "\"condition\"", "m.json.condition_number: got no such entry"},
      {fit_rate, "\"rate_hz\": \"fast\"", "m.json.fit.rate_hz: got \"fast\""},
      {fit_rate, "\"rate_hz\": null", "m.json.fit.rate_hz: got null"},
      {fit_rate, "\"rate_hz\": 1e999", "m.json"},
      {fit_rate, "\"rate_hz\": -1.0", "m.json.fit"},
      {"\"rate_hz\": 1000.0", "\"rate_hz\": 500.0", "control.rate_hz"},
      {"\"refined\": true", "\"refined\": 1", "m.json.refined"},
      {"\"samples\": 1500", "\"samples\": -3", "m.json.heldout.samples"},
      {"\"denominator\": [", "\"denominator\": [ 1.0,",
       "m.json.fit.denominator: got 6 numbers, want 5"},
      {"\"denominator\": [\n      1.0", "\"denominator\": [ 2.0", "m.json.fit"},
      {"\"denominator\": [\n      1.0,\n      -", "\"denominator\": [ 1.0, -9", "unstable"},
      {"\"numerator\": [", "\"numerator\": [ null,", "m.json.fit.numerator[0]: got null"},
      {"\"numerator\": [", "\"numerator\": [1,1,1,1,1,1,1,1,1,1,1,1,1,1,", "1 to 13 numbers"},
      {"\"version\": 1", "\"version\": 2", "newer stillhand"}};
  for (const auto& [from, to, said] : cases) {
    EXPECT_THAT(refusal(replaced(good, from, to)), HasSubstr(said)) << to;
  }
  EXPECT_THAT(refusal("[]"), HasSubstr("an object"));
  EXPECT_THAT(refusal("{\"format\": \"other\"}"), HasSubstr("m.json.format: got \"other\""));
}

TEST(ModelFileTest, WhatCannotBeReadIsNotWritten) {
  FeedthroughModel sut = model();
  sut.heldout.free_run_rms_n = std::nan("");
  EXPECT_THROW(model_json(sut), ConfigError);
  sut = model();
  sut.fit.denominator[1] = -9.0;
  EXPECT_THROW(model_json(sut), ConfigError);
}

}  // namespace
}  // namespace stillhand::identification::model_file_test
