// SPDX-License-Identifier: Apache-2.0
// The parsed file itself, and that what a program prints of a Config it reads back.
#include "services/files/settings/section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/files/settings/load.hpp"
#include "services/files/settings/yaml_text.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::settings::section_test {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kHuge = std::numeric_limits<double>::max();

Entry parsed(const std::string& yaml) { return parse_text(yaml, "lab.yaml"); }

std::string parse_error(const std::string& yaml) {
  return support::refusal([&] { parsed(yaml); });
}

TEST(ParseTextTest, EveryValueHasItsKindAndItsPlace) {
  const Entry sut = parsed("gain: 2\nname: \"2\"\nlist: [a, b]\nbody:\n  mass: 1\nempty:\n");
  ASSERT_EQ(sut.children.size(), 5u);
  const Entry& gain = sut.children[0];
  EXPECT_EQ(gain.kind, Entry::Kind::kScalar);
  EXPECT_EQ(gain.text, "2");
  EXPECT_FALSE(gain.quoted);
  EXPECT_EQ(gain.key_place, "lab.yaml:1:1");
  EXPECT_EQ(gain.place, "lab.yaml:1:7");
  EXPECT_TRUE(sut.children[1].quoted);
  EXPECT_EQ(sut.children[2].kind, Entry::Kind::kSequence);
  EXPECT_EQ(sut.children[2].children.at(1).text, "b");
  EXPECT_EQ(sut.children[2].children.at(1).place, "lab.yaml:3:11");
  EXPECT_EQ(sut.children[3].kind, Entry::Kind::kMap);
  EXPECT_EQ(sut.children[3].children.at(0).place, "lab.yaml:5:9");
  EXPECT_EQ(sut.children[4].kind, Entry::Kind::kNull);
}

TEST(ParseTextTest, AnEntryIsDescribedByItsTextOrItsKind) {
  const Entry sut = parsed("a: words\nb: [1]\nc: {d: 1}\ne:\n");
  EXPECT_EQ(got_of(sut.children[0]), "words");
  EXPECT_EQ(got_of(sut.children[1]), "a list");
  EXPECT_EQ(got_of(sut.children[2]), "a map");
  EXPECT_EQ(got_of(sut.children[3]), "nothing");
}

TEST(ParseTextTest, AnAliasStandsForWhatItNames) {
  const Entry sut = parsed("left: &hand {mass: 3}\nright: *hand\n");
  ASSERT_EQ(sut.children.at(1).kind, Entry::Kind::kMap);
  EXPECT_EQ(sut.children[1].children.at(0).text, "3");
}

TEST(ParseTextTest, AKeyThatIsNoWordIsRefusedWithItsPlace) {
  EXPECT_THAT(parse_error("a: 1\n[b, c]: 2\n"), StartsWith("lab.yaml:2:1: got "));
}

TEST(ParseTextTest, ADoubledKeyIsRefusedInItsOwnMapOnly) {
  EXPECT_THAT(parse_error("a:\n  hz: 1\n  hz: 2\n"),
              AllOf(StartsWith("lab.yaml:3:3: got "), HasSubstr("lab.yaml:2:3")));
  EXPECT_EQ(parse_error("a:\n  hz: 1\nb:\n  hz: 2\n"), "accepted");
}

TEST(ParseTextTest, DeepButFiniteNestingHasALimit) {
  const auto nested = [](int levels) {
    std::string yaml;
    for (int i = 0; i < levels; ++i) {
      yaml += std::string(static_cast<std::size_t>(i), ' ') + "k:\n";
    }
    return yaml;
  };
  EXPECT_EQ(parse_error(nested(16)), "accepted");
  EXPECT_THAT(parse_error(nested(17)), StartsWith("lab.yaml:"));
  EXPECT_THAT(parse_error(nested(200)), StartsWith("lab.yaml:"));
}

TEST(ParseTextTest, AWholeFileOfCarriageReturnsAndAByteOrderMarkIsRead) {
  const Entry sut = parsed("\xef\xbb\xbfgain: 2\r\nname: left\r\n");
  ASSERT_EQ(sut.children.size(), 2u);
  EXPECT_EQ(sut.children[0].key, "gain");
  EXPECT_EQ(sut.children[0].text, "2");
  EXPECT_EQ(sut.children[1].text, "left");
}

TEST(SectionReaderTest, AListThatNoFieldReadsIsFoundByName) {
  const Entry section = parsed("inputs: [a_y, roll]\n");
  SectionReader sut(section, "lab");
  const Entry* inputs = sut.find("inputs");
  ASSERT_NE(inputs, nullptr);
  EXPECT_EQ(inputs->children.size(), 2u);
  EXPECT_EQ(sut.find("outputs"), nullptr);
  EXPECT_NO_THROW(sut.refuse_unknown());
}

TEST(SectionReaderTest, AKeyWithoutAFieldIsRefusedWithItsPlace) {
  const Entry section = parsed("a: 1\nb: 2\n");
  SectionReader sut(section, "lab");
  sut.find("a");
  EXPECT_THAT(support::refusal([&] { sut.refuse_unknown(); }),
              AllOf(StartsWith("lab.yaml:2:1: lab.b: got "), HasSubstr("one of a")));
}

TEST(SectionReaderTest, ASectionThatIsNoMapIsRefusedWithItsPlace) {
  const Entry section = parsed("rig: [1]\n");
  EXPECT_THAT(support::refusal([&] { const SectionReader sut(section.children.front(), "rig"); }),
              AllOf(StartsWith("lab.yaml:1:6: rig: got "), HasSubstr("a list")));
}

struct FilterConfig {
  double corner_hz = 10.0;
  bool bypassed = false;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("corner_hz", self.corner_hz, Range{-kHuge, kHuge}, "[Hz] corner");
    visit("bypassed", self.bypassed, Range{0.0, 1.0}, "left out");
  }
};

struct SensorConfig {
  double gain = 1.0;
  std::int64_t offset_counts = 0;
  std::string name = "left";
  FilterConfig filter;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("gain", self.gain, Range{-kHuge, kHuge}, "[-] gain");
    visit("offset_counts", self.offset_counts, Range{-kHuge, kHuge}, "[-] offset");
    visit("name", self.name, Range{0.0, 100.0}, "name");
    visit.group("filter", self.filter);
  }
};

std::string digits(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

double random_double(std::mt19937_64& engine) {
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-1000, 1000);
  return std::ldexp(mantissa(engine), exponent(engine));
}

// Written with the shortest digits, as `yaml_text` writes them, a number comes back bit for bit,
// from 2^-1000 to 2^1000.
TEST(SectionReaderTest, RandomSettingsAreReadBackBitForBit) {
  std::mt19937_64 engine(41);
  for (int i = 0; i < 500; ++i) {
    SensorConfig want;
    want.gain = random_double(engine);
    want.filter.corner_hz = random_double(engine);
    want.filter.bypassed = engine() % 2 == 0;
    want.offset_counts = static_cast<std::int64_t>(engine());
    const std::string yaml = "gain: " + digits(want.gain) +
                             "\noffset_counts: " + std::to_string(want.offset_counts) +
                             "\nfilter:\n  corner_hz: " + digits(want.filter.corner_hz) +
                             "\n  bypassed: " + (want.filter.bypassed ? "true" : "false") + "\n";
    const auto got = load_text<SensorConfig>(yaml, "sensor");
    ASSERT_EQ(got.gain, want.gain) << yaml;
    ASSERT_EQ(got.filter.corner_hz, want.filter.corner_hz) << yaml;
    ASSERT_EQ(got.filter.bypassed, want.filter.bypassed) << yaml;
    ASSERT_EQ(got.offset_counts, want.offset_counts) << yaml;
    ASSERT_EQ(yaml_text(got), yaml_text(want));
  }
}

TEST(SectionReaderTest, WholeNumbersKeepEveryBitToTheEndsOfTheirRange) {
  for (const std::int64_t want :
       {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(),
        (std::int64_t{1} << 53) + 1}) {
    EXPECT_EQ(load_text<SensorConfig>("offset_counts: " + std::to_string(want) + "\n", "sensor")
                  .offset_counts,
              want);
  }
}

TEST(SectionReaderTest, AQuotedNumberIsATextAndNoNumber) {
  EXPECT_EQ(load_text<SensorConfig>("name: \"12\"\n", "sensor").name, "12");
  EXPECT_EQ(load_text<SensorConfig>("name: ''\n", "sensor").name, "");
  EXPECT_THROW(load_text<SensorConfig>("gain: '12'\n", "sensor"), ConfigError);
  EXPECT_THROW(load_text<SensorConfig>("gain: +12\n", "sensor"), ConfigError);
  EXPECT_THROW(load_text<SensorConfig>("gain: 1,5\n", "sensor"), ConfigError);
  EXPECT_THROW(load_text<SensorConfig>("gain: 1_000\n", "sensor"), ConfigError);
}

}  // namespace stillhand::settings::section_test
