// SPDX-License-Identifier: Apache-2.0
#include "services/settings/describe.hpp"

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

}  // namespace
}  // namespace stillhand::settings
