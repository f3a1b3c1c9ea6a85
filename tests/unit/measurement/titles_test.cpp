// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/titles.hpp"

#include <gtest/gtest.h>

namespace stillhand::measurement::titles_test {

TEST(TitlesTest, NameAndUnitAreFoundInTheUsualForms) {
  struct Case {
    const char* title;
    const char* name;
    const char* unit;
  };
  for (const Case& each :
       {Case{"acc [m/s^2]", "acc", "m/s^2"}, Case{" \"acc (g)\" ", "acc", "g"},
        Case{"t/s", "t", "s"}, Case{"a / m/s²", "a", "m/s²"}, Case{"acc", "acc", ""},
        Case{"left/right", "left/right", ""}, Case{"x[3][mm]", "x[3]", "mm"},
        Case{"[N]", "[N]", ""}, Case{"f []", "f []", ""}, Case{"", "", ""}, Case{"/s", "/s", ""}}) {
    const Title sut = parse_title(each.title);
    EXPECT_EQ(sut.name, each.name) << each.title;
    EXPECT_EQ(sut.unit, each.unit) << each.title;
  }
}

}  // namespace stillhand::measurement::titles_test
