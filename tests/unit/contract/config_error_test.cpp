// SPDX-License-Identifier: Apache-2.0
#include "services/core/contract/config_error.hpp"

#include <gtest/gtest.h>

#include <string>

namespace stillhand::config_error_test {
namespace {

TEST(ConfigErrorTest, SaysWhatWhereAndWhatWouldBeRight) {
  EXPECT_STREQ(ConfigError("rig.mass_kg", "-1", "0 to 9").what(),
               "rig.mass_kg: got -1, want 0 to 9");
}

TEST(ConfigErrorTest, IsOneLineWhateverAFileHolds) {
  using std::string_literals::operator""s;
  EXPECT_STREQ(ConfigError("lab", "a\nb\0c\x1b[31md\x7f"s, "a name").what(),
               "lab: got a?b?c?[31md?, want a name");
  EXPECT_STREQ(ConfigError("a\nb.yaml", "gr\u00fcn", "a name").what(),
               "a?b.yaml: got gr\u00fcn, want a name");
}

TEST(ConfigErrorTest, ALongTextIsCutBetweenCharacters) {
  std::string text = "x";
  for (int i = 0; i < 10'000; ++i) text += "\u00fc";
  const std::string shown = in_one_line(text);
  EXPECT_LE(shown.size(), 1003u);
  EXPECT_EQ(shown.substr(shown.size() - 5), "\u00fc...");
  EXPECT_EQ(in_one_line("short"), "short");
  EXPECT_EQ(in_one_line(std::string(1000, 'a')), std::string(1000, 'a'));
  EXPECT_EQ(in_one_line(std::string(1001, 'a')), std::string(1000, 'a') + "...");
}

}  // namespace
}  // namespace stillhand::config_error_test
