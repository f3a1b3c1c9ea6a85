// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/json_entry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "tests/support/refusal.hpp"

namespace stillhand::settings::json_entry_test {

using support::refusal;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class JsonEntryTest : public testing::Test {
 protected:
  const JsonEntry::Json json_ = parsed_json(R"({
    "rate": 50.5, "order": 4, "minus": -4, "whole": 3.0, "name": "left", "empty": "",
    "on": true, "none": null, "list": [1, 2.5, -3], "mixed": [1, "two"], "nothing": [],
    "largest": 9223372036854775807, "larger": 9223372036854775808,
    "body": {"modes": [{"hz": 2.5}, {"hz": "fast"}]}
  })",
                                            "model.json", "JSON of a model");
  const JsonEntry sut_{json_, "model.json"};

  std::string error_of(const std::string& key,
                       const std::function<void(const JsonEntry&)>& read) const {
    return refusal([&] { read(sut_.at(key)); });
  }
};

TEST_F(JsonEntryTest, EveryTypeIsReadAsItself) {
  EXPECT_EQ(sut_.at("rate").number(), 50.5);
  EXPECT_EQ(sut_.at("order").number(), 4.0);
  EXPECT_EQ(sut_.at("order").count(), 4u);
  EXPECT_EQ(sut_.at("order").whole(), 4);
  EXPECT_EQ(sut_.at("minus").number(), -4.0);
  EXPECT_EQ(sut_.at("minus").whole(), -4);
  EXPECT_EQ(sut_.at("name").text(), "left");
  EXPECT_EQ(sut_.at("empty").text(), "");
  EXPECT_TRUE(sut_.at("on").boolean());
  EXPECT_TRUE(sut_.at("none").is_null());
  EXPECT_FALSE(sut_.at("on").is_null());
  EXPECT_THAT(sut_.at("list").numbers(0, 9), ElementsAre(1.0, 2.5, -3.0));
  EXPECT_TRUE(sut_.at("nothing").entries(0, 0).empty());
}

TEST_F(JsonEntryTest, AWrongTypeIsRefusedWithPathAndContent) {
  const auto number = [](const JsonEntry& e) { (void)e.number(); };
  const auto count = [](const JsonEntry& e) { (void)e.count(); };
  const auto whole = [](const JsonEntry& e) { (void)e.whole(); };
  const auto boolean = [](const JsonEntry& e) { (void)e.boolean(); };
  const auto text = [](const JsonEntry& e) { (void)e.text(); };
  EXPECT_THAT(error_of("name", number), StartsWith("model.json.name: got \"left\", want "));
  EXPECT_THAT(error_of("none", number), StartsWith("model.json.none: got null, want "));
  EXPECT_THAT(error_of("on", number), StartsWith("model.json.on: got true, want "));
  EXPECT_THAT(error_of("minus", count), StartsWith("model.json.minus: got -4, want "));
  EXPECT_THAT(error_of("whole", count), StartsWith("model.json.whole: got 3.0, want "));
  EXPECT_THAT(error_of("whole", whole), StartsWith("model.json.whole: got 3.0, want "));
  EXPECT_EQ(error_of("largest", whole), "accepted");
  EXPECT_THAT(error_of("larger", whole), StartsWith("model.json.larger: got 9223372036854775808"));
  EXPECT_THAT(error_of("order", boolean), StartsWith("model.json.order: got 4, want "));
  EXPECT_THAT(error_of("rate", text), StartsWith("model.json.rate: got 50.5, want "));
}

TEST_F(JsonEntryTest, AMissingEntryAndAnEntryOfNoObjectAreNamed) {
  EXPECT_THAT(refusal([&] { (void)sut_.at("ratte"); }), StartsWith("model.json.ratte: got "));
  EXPECT_THAT(error_of("list", [](const JsonEntry& e) { (void)e.at("hz"); }),
              StartsWith("model.json.list: got [1,2.5,-3], want "));
}

TEST_F(JsonEntryTest, ThePathToADeepEntryHasItsKeysAndItsIndex) {
  const auto modes = sut_.at("body").at("modes").entries(1, 4);
  EXPECT_EQ(modes.at(0).at("hz").number(), 2.5);
  EXPECT_EQ(modes.at(1).path(), "model.json.body.modes[1]");
  EXPECT_THAT(refusal([&] { (void)modes.at(1).at("hz").number(); }),
              StartsWith("model.json.body.modes[1].hz: got \"fast\""));
}

TEST_F(JsonEntryTest, AnArrayKeepsItsBoundsOnTheNumberOfEntries) {
  const auto numbers = [](std::size_t least, std::size_t most) {
    return [=](const JsonEntry& e) { (void)e.numbers(least, most); };
  };
  EXPECT_EQ(error_of("list", numbers(3, 3)), "accepted");
  EXPECT_THAT(error_of("list", numbers(4, 9)), AllOf(HasSubstr("4 to 9"), HasSubstr(".list")));
  EXPECT_THAT(error_of("list", numbers(0, 2)), AllOf(HasSubstr("0 to 2"), HasSubstr(".list")));
  EXPECT_THAT(error_of("body", numbers(0, 9)), StartsWith("model.json.body: got {"));
  EXPECT_THAT(error_of("mixed", numbers(0, 9)), StartsWith("model.json.mixed[1]: got \"two\""));
  EXPECT_THAT(error_of("nothing", [](const JsonEntry& e) { (void)e.entries(1, 2); }),
              StartsWith("model.json.nothing: got []"));
}

TEST_F(JsonEntryTest, AKeyWithoutMeaningIsRefusedAndTheMeaningfulOnesAreListed) {
  const JsonEntry body = sut_.at("body");
  EXPECT_NO_THROW(body.allow_only({"order", "modes"}));
  EXPECT_THAT(refusal([&] { body.allow_only({"order", "rate"}); }),
              AllOf(StartsWith("model.json.body.modes: got "), HasSubstr("order, rate")));
  EXPECT_THAT(error_of("name", [](const JsonEntry& e) { e.allow_only({"a"}); }),
              StartsWith("model.json.name: got \"left\""));
}

// 60 characters and the dots, so that an array of a million numbers stays one line.
TEST_F(JsonEntryTest, LongContentIsShownFromItsBeginningOnly) {
  const JsonEntry::Json json = std::vector<int>(1000, 7);
  const JsonEntry sut(json, "m");
  const std::string message = refusal([&] { (void)sut.number(); });
  EXPECT_THAT(message, AllOf(StartsWith("m: got [7,7,7,"), HasSubstr("...")));
  EXPECT_LT(message.size(), 120u);
}

TEST_F(JsonEntryTest, BytesThatAreNoUtf8DoNotBreakTheMessage) {
  const JsonEntry::Json json = std::string("\xff\xfe");
  const JsonEntry sut(json, "m");
  EXPECT_THAT(refusal([&] { (void)sut.number(); }), StartsWith("m: got \""));
}

TEST_F(JsonEntryTest, ANumberThatIsNotFiniteIsRefused) {
  for (const double value :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    const JsonEntry::Json json = value;
    EXPECT_THAT(refusal([&] { (void)JsonEntry(json, "m").number(); }), HasSubstr("finite"));
  }
}

std::string parse_error(const std::string& text) {
  return refusal([&] { parsed_json(text, "inventory.json", "JSON of an inventory"); });
}

TEST(ParsedJsonTest, ASyntaxErrorIsRefusedWithLineAndColumn) {
  const std::string message = parse_error("{\n  \"a\": 1,\n  \"b\" 2\n}");
  EXPECT_THAT(message, AllOf(StartsWith("inventory.json: got "), HasSubstr("line 3"),
                             HasSubstr("column"), HasSubstr("want JSON of an inventory")));
  EXPECT_THAT(message, testing::Not(HasSubstr("json.exception")));
}

TEST(ParsedJsonTest, TextThatIsCutOffIsRefusedWhereverTheCutIs) {
  const std::string whole = R"({"a": [1, {"b": "c"}], "d": true})";
  EXPECT_EQ(parse_error(whole), "accepted");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THAT(parse_error(whole.substr(0, length)), StartsWith("inventory.json: got "))
        << length << " bytes";
  }
}

TEST(ParsedJsonTest, ADoubledKeyIsRefusedInItsOwnObjectOnly) {
  EXPECT_THAT(parse_error(R"({"rate": 1, "rate": 2})"), HasSubstr("\"rate\""));
  EXPECT_THAT(parse_error(R"({"a": {"hz": 1, "b": {}, "hz": 2}})"), HasSubstr("\"hz\""));
  EXPECT_EQ(parse_error(R"({"a": {"hz": 1}, "b": {"hz": 2}, "c": [{"hz": 3}, {"hz": 4}]})"),
            "accepted");
}

TEST(ParsedJsonTest, ANumberBeyondADoubleIsRefused) {
  EXPECT_THAT(parse_error(R"({"a": 1e999})"),
              AllOf(StartsWith("inventory.json: got "), HasSubstr("1e999")));
}

TEST(ParsedJsonTest, NotANumberAndCommentsAreNoJson) {
  for (const char* text : {"NaN", "{\"a\": nan}", "{\"a\": Infinity}", "{} // end", "{'a': 1}"}) {
    EXPECT_THAT(parse_error(text), StartsWith("inventory.json: got ")) << text;
  }
}

}  // namespace stillhand::settings::json_entry_test
