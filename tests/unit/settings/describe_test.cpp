// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/describe.hpp"

#include <gtest/gtest.h>

#include <string>

namespace stillhand::settings {
namespace {

struct InnerConfig {
  bool pegged = true;
  std::string name = "left";

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("pegged", self.pegged, Range{0.0, 1.0}, "peg in");
    visit("name", self.name, Range{1.0, 8.0}, "a | b");
  }
};

struct OuterConfig {
  double gain = 0.1;
  std::int64_t delay_ticks = 3;
  InnerConfig stick;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("gain", self.gain, Range{-1.5, 2.0}, "[-] gain");
    visit.group("stick", self.stick);
    visit("delay_ticks", self.delay_ticks, Range{0.0, 50.0}, "[ticks] delay");
  }
};

TEST(DescribeTest, EveryFieldIsARowInTheOrderOfTheConfig) {
  EXPECT_EQ(describe(OuterConfig{}),
            "| name | default | range | doc |\n"
            "| --- | --- | --- | --- |\n"
            "| `gain` | 0.1 | -1.5 to 2 | [-] gain |\n"
            "| `stick.pegged` | true | true, false | peg in |\n"
            "| `stick.name` | \"left\" | 1 to 8 characters | a \\| b |\n"
            "| `delay_ticks` | 3 | 0 to 50 | [ticks] delay |\n");
}

struct LockedConfig {
  bool locked = true;
  double tiny = 5e-324;  // the smallest double

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("locked", self.locked, Range{1.0, 1.0}, "locked");
    visit("tiny", self.tiny, Range{-1.0 / 3.0, 1e300}, "[-] tiny");
  }
};

TEST(DescribeTest, ASwitchWithOnePositionShowsItAndANumberKeepsAllItsDigits) {
  EXPECT_EQ(describe(LockedConfig{}),
            "| name | default | range | doc |\n"
            "| --- | --- | --- | --- |\n"
            "| `locked` | true | true | locked |\n"
            "| `tiny` | 5e-324 | -0.3333333333333333 to 1e+300 | [-] tiny |\n");
}

}  // namespace
}  // namespace stillhand::settings
