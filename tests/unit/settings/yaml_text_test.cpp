// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/yaml_text.hpp"

#include <gtest/gtest.h>

#include "services/core/rig/rig.hpp"
#include "services/files/settings/load.hpp"

namespace stillhand::settings::yaml_text_test {

TEST(YamlTextTest, WhatIsWrittenReadsAsTheSameSettings) {
  rig::RigConfig config;
  config.body.trunk_mass_kg = 31.0 / 1.1;
  config.body.neuromuscular.tremor_force_n = 1e-7;
  const auto again = load_text<rig::RigConfig>(yaml_text(config), "rig");
  EXPECT_EQ(yaml_text(again), yaml_text(config));
  EXPECT_EQ(again.body.neuromuscular.tremor_force_n, config.body.neuromuscular.tremor_force_n);
  EXPECT_EQ(again.body.trunk_mass_kg, config.body.trunk_mass_kg);
}

struct Words {
  std::string text = "it's: # \"new\"";
  bool flag = true;
  std::int64_t count = 4294967295;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("text", self.text, Range{0, 100}, "");
    visit("flag", self.flag, Range{0, 1}, "");
    visit("count", self.count, Range{0, 1e10}, "");
  }
};

TEST(YamlTextTest, AStringThatYamlWouldReadOtherwiseIsQuoted) {
  const Words words{.flag = false};
  const Words again = load_text<Words>(yaml_text(words), "words");
  EXPECT_EQ(again.text, words.text);
  EXPECT_FALSE(again.flag);
  EXPECT_EQ(again.count, words.count);
}

}  // namespace stillhand::settings::yaml_text_test
