// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace stillhand::measurement::choice_test {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Pair;

TableHead head_of(const std::vector<const char*>& names) {
  TableHead head;
  for (const char* name : names) head.columns.push_back({std::string(name) + " [N]", name, "N"});
  return head;
}

TEST(ChoiceTest, AColumnIsItsTitleBeforeItsNameItsPlaceAndAnotherCase) {
  TableHead head = head_of({"a", "A", "b", "B", "b", "#3", "Z_z"});
  head.columns[1].title = "b";
  for (const auto& [from, place] : {std::pair("a", 0u),
                                    {"a [N]", 0u},
                                    {"b", 1u},
                                    {"B [N]", 3u},
                                    {"#3", 5u},
                                    {"#1", 0u},
                                    {"#7", 6u},
                                    {"z_Z", 6u}}) {
    EXPECT_EQ(find_column(head, from), place) << from;
  }
  for (const char* none : {"#0", "#8", "1", "c"}) {
    EXPECT_THAT(support::refusal([&] { find_column(head, none); }), HasSubstr("is no column"));
  }
  EXPECT_THAT(support::refusal([&] { find_column(head, "b [N]"); }),
              HasSubstr("got 'b [N]', the title of 2 columns, want its place, such as '#2'"));
  EXPECT_EQ(lower_case("@AZ[`az{"), "@az[`az{");
}

TEST(ChoiceTest, AMessageListsADozenTitles) {
  std::vector<const char*> names(12, "a");
  EXPECT_THAT(titles_of(head_of(names)), EndsWith("'a [N]'"));
  names.push_back("b");
  EXPECT_THAT(titles_of(head_of(names)), EndsWith("'a [N]' and 1 more"));
  EXPECT_EQ(titles_of(head_of({"a", "b"})), "'a [N]', 'b [N]'");
}

TEST(ChoiceTest, TheTimeIsAtItsPlaceInTheMappingAndEachChannelComesOnce) {
  Mapping mapping;
  for (const char* wish : {"b=f [N]", "c=t [s]", "a=g"})
    mapping.columns.push_back(parse_wish(wish));
  const Choice sut = choose(head_of({"a", "b", "c"}), mapping);
  EXPECT_THAT(sut.columns, ElementsAre(1, 2, 0));
  EXPECT_EQ(sut.time, 1u);
  mapping.columns.push_back(parse_wish("a=f"));
  EXPECT_THAT(support::refusal([&] { choose(head_of({"a", "b", "c"}), mapping); }),
              HasSubstr("a second 'f'"));
}

// Of a column's unit, a file's unit of angles, and a mapping: of the values, and of the channel.
TEST(ChoiceTest, UnitsAreTheMappingsWhereItSaysAnotherThanTheChannelsOwn) {
  struct Case {
    const char* unit;
    const char* angle_unit;
    const char* wish;
    const char* from;
    const char* to;
  };
  for (const Case& each : {Case{"", "", "c=f", "N", "N"},
                           {"kN", "", "c=f", "kN", "N"},
                           {"kN", "", "c=f [N]", "kN", "N"},
                           {"kN", "", "c=f [mN]", "mN", "N"},
                           {"", "", "c=f [mN]", "mN", "N"},
                           {"", "deg", "c=theta", "deg", "rad"},
                           {"", "deg", "c=omega", "deg/s", "rad/s"},
                           {"", "", "c=omega", "rad/s", "rad/s"},
                           {"", "deg", "c=f", "N", "N"},
                           {"rad", "deg", "c=theta", "rad", "rad"},
                           {"%", "", "c=grip", "%", "%"},
                           {"%", "", "c=grip [1]", "%", "1"},
                           {"", "", "c=grip [kPa]", "kPa", "kPa"},
                           {"V", "", "c=grip [kPa] * 3 [kPa/V]", "V", "kPa"},
                           {"V", "", "c=grip * 3 [kPa/V]", "V", ""}}) {
    const ColumnHead column{"c", "c", each.unit, 0, each.angle_unit};
    EXPECT_THAT(units_of(column, parse_wish(each.wish)), Pair(each.from, each.to))
        << each.unit << "; " << each.wish;
  }
}

// The title in V and a mapping in mN cannot both be right, unless a gain stands between them.
TEST(ChoiceTest, TwoUnitsOfOneColumnMeasureTheSame) {
  const ColumnHead column{"c [V]", "c", "V"};
  const auto converted = [&](const char* wish, double value) {
    std::vector<double> values{value};
    conversion_of({}, column, parse_wish(wish)).apply(values);
    return values[0];
  };
  EXPECT_EQ(converted("c=grip [mV]", 2.0), 2000.0);
  EXPECT_EQ(converted("c=f [V] * 22.5 [N/V]", 2.0), 45.0);
  EXPECT_EQ(converted("c=f * 22.5 [N/V]", 2.0), 45.0);
  for (const char* wish : {"c=f [mN]", "c=f", "c=grip [kPa]"}) {
    EXPECT_THAT(support::refusal([&] { converted(wish, 2.0); }), HasSubstr("or a gain")) << wish;
  }
}

}  // namespace stillhand::measurement::choice_test
