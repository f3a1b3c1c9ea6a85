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
  const std::string head = "module m { enum K { A, B }; ";
  const std::string in = "struct In { double x; sequence<long, 4> n; }; ";
  EXPECT_EQ(difference(head + in + "struct P { unsigned long rig; K kind; In in; }; };"),
            "text is missing");
  EXPECT_EQ(
      difference(head + in +
                 "struct P { unsigned long rig; K kind; In in; string<20> text; long z; }; };"),
      "z is additional");
  EXPECT_EQ(
      difference(head + in + "struct P { unsigned long rig; In in; K kind; string<20> text; }; };"),
      "in is in the place of kind");
  EXPECT_EQ(difference(head + in + "struct P { long rig; K kind; In in; string<20> text; }; };"),
            "rig is of another type");
  EXPECT_EQ(
      difference(head + "struct In { float x; sequence<long, 4> n; }; "
                        "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
      "in.x is of another type");
  EXPECT_EQ(
      difference(head + "struct In { double x; sequence<double, 4> n; }; "
                        "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
      "in.n[] is of another type");
  EXPECT_EQ(difference("module m { enum K { A, B, C }; " + in +
                       "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
            "kind has other values");
  EXPECT_EQ(difference("module m { enum K { B }; " + in +
                       "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
            "kind has other values");
  EXPECT_EQ(difference("module m { struct Q { long a; }; };"),
            "its schema does not define the type");
}

TEST(SameDefinitionTest, ValuesThatWereAddedSinceDoNotCount) {
  EXPECT_EQ(difference("module m { enum K { A }; struct In { double x; sequence<long, 4> n; };\n"
                       "struct P { unsigned long rig; K kind; In in; string<20> text; }; };"),
            "");
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
