// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/edit_text.hpp"

#include <gtest/gtest.h>

namespace stillhand::settings::edit_text_test {

TEST(WithSettingTest, ChangesALineAndKeepsItsComment) {
  EXPECT_EQ(with_setting("a: 1   # [V] why\nb: 2\n", "a", "3"), "a: 3   # [V] why\nb: 2\n");
  EXPECT_EQ(with_setting("a: 1   # [V] why\n", "a", "1.2345678"), "a: 1.2345678  # [V] why\n");
}

TEST(WithSettingTest, UsesALineThatIsCommentedOut) {
  EXPECT_EQ(with_setting("# gain: 0.1    # [V/N] gain\n#              # more\n", "gain", "0.2"),
            "gain: 0.2      # [V/N] gain\n#              # more\n");
}

TEST(WithSettingTest, PrefersTheLineThatCounts) {
  EXPECT_EQ(with_setting("# a: 1\na: 2\n", "a", "3"), "# a: 1\na: 3\n");
}

TEST(WithSettingTest, AddsAKeyAtTheEnd) {
  EXPECT_EQ(with_setting("", "a", "3"), "a: 3\n");
  EXPECT_EQ(with_setting("ab: 1", "a", "3"), "ab: 1\na: 3\n");
}

TEST(WithSettingTest, LeavesGroupsAndLongerNamesAlone) {
  EXPECT_EQ(with_setting("g:\n  a: 1\naa: 2\n", "a", "3"), "g:\n  a: 1\naa: 2\na: 3\n");
}

}  // namespace stillhand::settings::edit_text_test
