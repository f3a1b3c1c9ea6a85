// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/load.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::settings::load_test {

using testing::HasSubstr;

struct InnerConfig {
  double stiffness_n_m = 5.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("stiffness_n_m", self.stiffness_n_m, Range{0.0, 100.0}, "[N/m] spring");
  }
};

struct OuterConfig {
  double mass_kg = 1.5;
  std::int64_t delay_ticks = 3;
  bool pegged = false;
  std::string name = "rig";
  InnerConfig body;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("mass_kg", self.mass_kg, Range{0.1, 10.0}, "[kg] mass");
    visit("delay_ticks", self.delay_ticks, Range{0.0, 50.0}, "[ticks] delay");
    visit("pegged", self.pegged, Range{0.0, 1.0}, "peg in");
    visit("name", self.name, Range{1.0, 8.0}, "left or right");
    visit.group("body", self.body);
  }
};

OuterConfig loaded(const std::string& yaml) {
  return load_text<OuterConfig>(yaml, "rig", "rig.yaml");
}

std::string message_of(const std::string& yaml) {
  return support::refusal([&] { loaded(yaml); });
}

TEST(LoadTest, EveryFieldIsReadFromItsKey) {
  const auto sut = loaded(
      "mass_kg: 2.5\ndelay_ticks: 7\npegged: true\nname: left\nbody:\n  stiffness_n_m: 1e1\n");
  EXPECT_EQ(sut.mass_kg, 2.5);
  EXPECT_EQ(sut.delay_ticks, 7);
  EXPECT_TRUE(sut.pegged);
  EXPECT_EQ(sut.name, "left");
  EXPECT_EQ(sut.body.stiffness_n_m, 10.0);
}

TEST(LoadTest, MissingKeysKeepTheirDefaults) {
  for (const char* yaml : {"", "# nothing\n", "{}\n", "body:\n", "delay_ticks: 3\n"}) {
    const auto sut = loaded(yaml);
    EXPECT_EQ(sut.mass_kg, 1.5) << yaml;
    EXPECT_EQ(sut.name, "rig") << yaml;
    EXPECT_EQ(sut.body.stiffness_n_m, 5.0) << yaml;
  }
}

TEST(LoadTest, AnUnknownKeyIsRefusedWithItsPlaceAndTheNearestName) {
  EXPECT_EQ(message_of("mass_kg: 1\n\n  \nmas_kg: 2\n"),
            "rig.yaml:4:1: rig.mas_kg: got an unknown key, want \"mass_kg\" perhaps");
  EXPECT_EQ(message_of("body:\n  stifness_n_m: 2\n"),
            "rig.yaml:2:3: rig.body.stifness_n_m: got an unknown key, want \"stiffness_n_m\" "
            "perhaps");
  EXPECT_THAT(message_of("boddy: {}\n"), HasSubstr("\"body\" perhaps"));
  EXPECT_THAT(message_of("temperature: 1\n"), HasSubstr("an unknown key, want one of mass_kg, "));
}

TEST(LoadTest, AValueOutOfItsRangeIsRefusedWithItsPlace) {
  EXPECT_EQ(message_of("name: a\nmass_kg: 10.5\n"),
            "rig.yaml:2:10: rig.mass_kg: got 10.5, want a value from 0.1 to 10");
  EXPECT_THAT(message_of("delay_ticks: -1\n"), HasSubstr("rig.yaml:1:14: rig.delay_ticks: got -1"));
  EXPECT_THAT(message_of("name: far_too_long\n"), HasSubstr("text of 1 to 8 characters"));
  EXPECT_EQ(message_of("name: [left]\n"),
            "rig.yaml:1:7: rig.name: got a list, want text of 1 to 8 characters: left or right");
  EXPECT_EQ(message_of("mass_kg: 10\n"), "accepted");
}

TEST(LoadTest, AWrongTypeIsRefused) {
  for (const char* yaml :
       {"mass_kg: heavy\n", "mass_kg: 1.5 kg\n", "mass_kg: \"1.5\"\n", "mass_kg: [1]\n",
        "mass_kg: {a: 1}\n", "mass_kg:\n", "mass_kg: true\n", "mass_kg: 0x10\n",
        "delay_ticks: 2.5\n", "delay_ticks: 99999999999999999999\n", "pegged: yes\n", "pegged: 1\n",
        "pegged: \"true\"\n", "name: [a]\n", "name:\n", "body: 3\n", "body: [1]\n"}) {
    EXPECT_THAT(message_of(yaml), HasSubstr("rig.yaml:1:")) << yaml;
  }
}

TEST(LoadTest, NotANumberAndInfinityAreRefused) {
  for (const char* value : {".nan", "nan", ".inf", "inf", "-inf", "-.inf", "1e999"}) {
    EXPECT_THAT(message_of(std::string("mass_kg: ") + value + "\n"), HasSubstr("rig.mass_kg"))
        << value;
  }
}

TEST(LoadTest, ADuplicateKeyIsRefusedWithBothPlaces) {
  EXPECT_EQ(message_of("mass_kg: 1\nname: a\nmass_kg: 2\n"),
            "rig.yaml:3:1: got a second \"mass_kg\", want each key once; the first is at "
            "rig.yaml:1:1");
}

// Not a crash, and not a machine that is busy for ever.
TEST(LoadTest, AliasesWithoutEndAreRefused) {
  EXPECT_THAT(message_of("body: &b [*b]\n"), HasSubstr("endless settings"));
  std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 1; k < 10; ++k) laughs += ", " + before;
    laughs += "]\n";
  }
  EXPECT_THAT(message_of(laughs), HasSubstr("endless settings"));
}

TEST(LoadTest, MalformedYamlIsRefusedWithItsPlace) {
  EXPECT_THAT(message_of("mass_kg: [1, 2\nname: a\n"), HasSubstr("want well-formed YAML"));
  EXPECT_THAT(message_of("mass_kg: 1\n\tname: a\n"), HasSubstr("rig.yaml:2:"));
  EXPECT_THAT(message_of("- 1\n- 2\n"), HasSubstr("got a list, want a map of settings"));
  EXPECT_THAT(message_of("just words\n"), HasSubstr("want a map of settings"));
  EXPECT_THAT(message_of("mass_kg: 1\n---\nmass_kg: 2\n"),
              HasSubstr("rig.yaml:2:1: got a second document, want one"));
}

// For each of these, YAML::LoadAll() takes memory and never returns.
TEST(LoadTest, ASignThatBeginsNoValueIsRefused) {
  EXPECT_THAT(message_of(", mass_kg: 1\n"), HasSubstr("rig.yaml:1:1: got a sign that begins no"));
  EXPECT_THAT(message_of("mass_kg: 1\n---\n, b\n"), HasSubstr("got a second document"));
}

TEST(LoadTest, AFileIsReadAndNamedInMessages) {
  const support::Folder folder;
  const auto file = folder / "rig.yaml";
  std::ofstream(file) << "mass_kg: 3\n";
  EXPECT_EQ(load<OuterConfig>(file, "rig").mass_kg, 3.0);
  std::ofstream(file) << "mass_kg: 300\n";
  EXPECT_THAT(support::refusal([&] { load<OuterConfig>(file, "rig"); }),
              testing::StartsWith(file.string() + ":1:10: rig.mass_kg"));
}

TEST(LoadTest, AMissingFileAndAFolderAreRefused) {
  const support::Folder folder;
  EXPECT_THROW(load<OuterConfig>(folder / "absent.yaml", "rig"), ConfigError);
  EXPECT_THROW(load<OuterConfig>(folder.path(), "rig"), ConfigError);
}

}  // namespace stillhand::settings::load_test
