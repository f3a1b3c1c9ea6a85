// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/same_definition.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording::same_definition_test {
namespace {

constexpr const char* kKnown =
    "module m { enum K { A, B }; struct In { double x; sequence<long, 4> n; };\n"
    "struct P { @key unsigned long rig; // [-] rig\n K kind; In in; string<20> text; }; };";

std::string difference(const std::string& recorded) {
  return definition_difference(parse_idl(recorded, "recorded"), parse_idl(kKnown, "known"), "m::P");
}

TEST(SameDefinitionTest, CommentsUnitsAndOtherTypesOfTheFileDoNotCount) {
  EXPECT_EQ(difference(kKnown), "");
  EXPECT_EQ(difference("module m { struct New { long a; }; enum K { A, B };\n"
                       "struct In { double x; sequence<long, 4> n; };\n"
                       "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
            "");
}

TEST(SameDefinitionTest, EveryDifferenceThatMovesAByteIsNamed) {
  const std::string in = "double x; sequence<long, 4> n;";
  const std::string p = "unsigned long rig; K kind; In in; string<20> text;";
  const struct {
    std::string values, in, p, difference;
  } cases[] = {
      {"A, B", in, "unsigned long rig; K kind; In in;", "text is missing"},
      {"A, B", in, p + " long z;", "z is additional"},
      {"A, B", in, "unsigned long rig; In in; K kind; string<20> text;",
       "in is in the place of kind"},
      {"A, B", in, "long rig; K kind; In in; string<20> text;", "rig is of another type"},
      {"A, B", "float x; sequence<long, 4> n;", p, "in.x is of another type"},
      {"A, B", "double x; sequence<double, 4> n;", p, "in.n[] is of another type"},
      {"A, B, C", in, p, "kind has other values"},
      {"B", in, p, "kind has other values"},
      {"A", in, p, ""},  // a value that was added since
  };
  for (const auto& [values, inner, outer, want] : cases) {
    EXPECT_EQ(difference("module m { enum K { " + values + " }; struct In { " + inner +
                         " }; struct P { " + outer + " }; };"),
              want);
  }
  EXPECT_EQ(difference("module m { struct Q { long a; }; };"),
            "its schema does not define the type");
}

TEST(SameDefinitionTest, MembersAtTheEndMayBeMissingWhereTheProgramReadsTheEarlierForm) {
  const auto earlier = [](const std::string& recorded) {
    return definition_difference(parse_idl(recorded, "recorded"), parse_idl(kKnown, "known"),
                                 "m::P", true);
  };
  const std::string head = "module m { enum K { A, B }; ";
  EXPECT_EQ(earlier(head + "struct In { double x; sequence<long, 4> n; }; "
                           "struct P { unsigned long rig; K kind; In in; }; };"),
            "");
  // Not within a member: what follows it would move.
  EXPECT_EQ(earlier(head + "struct In { double x; }; "
                           "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
            "in.n is missing");
}

}  // namespace
}  // namespace stillhand::recording::same_definition_test
