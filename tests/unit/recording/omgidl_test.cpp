// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/omgidl.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"

namespace stillhand::recording::omgidl_test {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

const IdlType& type_of(const IdlSchema& schema, const IdlStruct& of, std::size_t member) {
  return schema.types.at(of.members.at(member).type);
}

TEST(IdlSchemaTest, MembersHaveTheirKindsAndUnits) {
  const IdlSchema sut = parse_idl(R"(
module lab {
  // stream, 1 kHz [not a unit: no member stands on this line]
  struct Sensed {
    @key unsigned long rig;   // [-] number
    long long tick;           // the sample [1] of the clock
    double accel_m_s2;        // [m/s^2] lateral
    double x, y;              /* [m] both */
    @unit("rad") float angle; // [degrees] the annotation is believed
    boolean on; octet raw; char letter; short a; unsigned short b; uint8 c; int8 d; int64 e;
    string<32> name;
  };
};
)",
                                  "F");
  const IdlStruct* sensed = sut.find("lab::Sensed");
  ASSERT_NE(sensed, nullptr);
  EXPECT_EQ(sensed, sut.find("lab/Sensed"));
  EXPECT_EQ(sut.find("Sensed"), nullptr);
  std::vector<std::pair<std::string, std::string>> units;
  for (std::size_t i = 0; i < 6; ++i) {
    units.emplace_back(sensed->members[i].name, sensed->members[i].unit);
  }
  EXPECT_THAT(units, ElementsAre(Pair("rig", "-"), Pair("tick", ""), Pair("accel_m_s2", "m/s^2"),
                                 Pair("x", "m"), Pair("y", "m"), Pair("angle", "rad")));
  EXPECT_TRUE(sensed->members[0].key);
  EXPECT_FALSE(sensed->members[1].key);
  std::vector<IdlKind> kinds;
  for (std::size_t i = 0; i < sensed->members.size(); ++i) {
    kinds.push_back(type_of(sut, *sensed, i).kind);
  }
  using enum IdlKind;
  EXPECT_THAT(kinds, ElementsAre(kUint32, kInt64, kFloat64, kFloat64, kFloat64, kFloat32, kBoolean,
                                 kOctet, kChar, kInt16, kUint16, kOctet, kInt8, kInt64, kString));
}

TEST(IdlSchemaTest, EnumsArraysSequencesTypedefsAndConstantsAreResolved) {
  const IdlSchema sut = parse_idl(R"(
#include "other.idl"
const long kAxes = 3;
const string kName = "a; text };";
const double kPi = 3.14159;
module a {
  enum Phase { IDLE, @value(4) PEGGED, TRACKING };
  typedef double Vector[kAxes];
  typedef sequence<Vector, 2 * (kAxes + 1)> Path;
  module b { struct Inner { Phase phase; Vector force; }; };
  struct Outer : b::Inner { Path path; ::a::b::Inner nested; long grid[2][0x3]; sequence<string> names; };
};
)",
                                  "F");
  ASSERT_EQ(sut.enums.size(), 1u);
  EXPECT_THAT(sut.enums[0].values,
              ElementsAre(Pair(0, "IDLE"), Pair(4, "PEGGED"), Pair(5, "TRACKING")));
  const IdlStruct* outer = sut.find("a::Outer");
  ASSERT_NE(outer, nullptr);
  EXPECT_THAT(outer->members,
              ElementsAre(Field(&IdlMember::name, "phase"), Field(&IdlMember::name, "force"),
                          Field(&IdlMember::name, "path"), Field(&IdlMember::name, "nested"),
                          Field(&IdlMember::name, "grid"), Field(&IdlMember::name, "names")));
  EXPECT_EQ(type_of(sut, *outer, 1).length, 3u);
  const IdlType& path = type_of(sut, *outer, 2);
  EXPECT_EQ(path.kind, IdlKind::kSequence);
  EXPECT_EQ(sut.types[path.of].kind, IdlKind::kArray);
  const IdlType& grid = type_of(sut, *outer, 4);
  EXPECT_EQ(grid.length, 2u);
  EXPECT_EQ(sut.types[grid.of].length, 3u);
}

TEST(IdlSchemaTest, WhatIsNotDecodedIsReadOverUntilItIsNeeded) {
  const IdlSchema sut = parse_idl(R"(
@annotation mine { string text default "x"; };
union Either switch (long) { case 1: double x; default: string y; };
bitmask Bits { @position(0) A, B };
struct Later;
struct Plain { double x; };
@mutable struct Grown { @optional double y; Either either; map<long, string> m; wstring w; };
)",
                                  "F");
  ASSERT_NE(sut.find("Plain"), nullptr);
  const IdlStruct* grown = sut.find("Grown");
  ASSERT_NE(grown, nullptr);
  EXPECT_TRUE(grown->is_mutable);
  EXPECT_TRUE(grown->members[0].optional);
  for (const std::size_t i : {1u, 2u, 3u}) {
    EXPECT_EQ(type_of(sut, *grown, i).kind, IdlKind::kUnsupported) << i;
  }
  EXPECT_EQ(type_of(sut, *grown, 1).name, "union Either");
}

TEST(IdlSchemaTest, MistakesAreNamedWithLineAndColumn) {
  const auto mistake = [](const char* text, const char* words) {
    EXPECT_THAT([&] { (void)parse_idl(text, "F.mcap, schema 3"); },
                ThrowsMessage<ConfigError>(HasSubstr(words)))
        << text;
  };
  mistake("struct A {\n  doubble x;\n};",
          "F.mcap, schema 3, IDL line 2:3: got 'doubble', want a type");
  mistake("struct A { double x; }", "got the end of the text, want ;");
  mistake("struct A { double x[0]; };", "a length of at least 1");
  mistake("struct A { double x[9999999999]; };", "want a number of at most 32 bits");
  mistake("struct A { A again; };", "got 'A', want a type defined earlier");
  mistake("message Foo {}", "got 'message', want module, struct");
  mistake("module m { struct A { double x; };", "got the end of the text, want }");
  mistake("struct A { double 3x; };", "want a name");
  mistake("\x01\xff", "want");
}

TEST(IdlSchemaTest, LengthsAreComputedAsWrittenOrRefused) {
  const auto length_of = [](const std::string& expression) {
    const IdlSchema schema =
        parse_idl("const long n = 7; struct A { octet x[" + expression + "]; };", "F");
    return schema.types.at(schema.find("A")->members.at(0).type).length;
  };
  EXPECT_EQ(length_of("2+3*4"), 14u);
  EXPECT_EQ(length_of("(2+3)*4"), 20u);
  EXPECT_EQ(length_of("10-2-3"), 5u);
  EXPECT_EQ(length_of("-(-5)"), 5u);
  EXPECT_EQ(length_of("-2*-3"), 6u);
  EXPECT_EQ(length_of("010"), 8u) << "octal";
  EXPECT_EQ(length_of("0xFf"), 255u);
  EXPECT_EQ(length_of("n*n"), 49u);
  EXPECT_EQ(length_of("4294967295"), 4294967295u);
  EXPECT_EQ(length_of("65537*65535"), 4294967295u);
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '(') + "5" + std::string(depth, ')');
  };
  EXPECT_EQ(length_of(nested(64)), 5u);
  EXPECT_THROW((void)length_of(nested(65)), ConfigError);
  for (const char* wrong : {"4294967296",
                            "4294967295+1",
                            "4294967295*4294967295",
                            "3037000500*3037000500",
                            "-4294967295*4294967295",
                            "65536*65536*65536*65536",
                            "1-1",
                            "-3",
                            "08",
                            "0x",
                            "0xG",
                            "1.5",
                            "9x",
                            "99999999999999999999",
                            "m",
                            "",
                            "2+",
                            "*2",
                            "(2",
                            "2)"}) {
    EXPECT_THROW((void)length_of(wrong), ConfigError) << wrong;
  }
}

TEST(IdlSchemaTest, ANameIsFoundFromItsOwnModuleOutwards) {
  const IdlSchema sut = parse_idl(R"(
struct T { double outside; };
module a {
  struct T { double inside; };
  module b { struct U { T nearest; ::T first; a::T scoped; }; };
};
module a { struct V { b::U opened_again; T t; }; };
)",
                                  "F");
  const auto member_of = [&](const IdlStruct& of, std::size_t member) {
    return sut.structs.at(type_of(sut, of, member).of).name;
  };
  const IdlStruct* u = sut.find("a::b::U");
  ASSERT_NE(u, nullptr);
  EXPECT_EQ(member_of(*u, 0), "a::T");
  EXPECT_EQ(member_of(*u, 1), "T");
  EXPECT_EQ(member_of(*u, 2), "a::T");
  const IdlStruct* v = sut.find("a/V");
  ASSERT_NE(v, nullptr);
  EXPECT_EQ(member_of(*v, 0), "a::b::U");
  EXPECT_EQ(member_of(*v, 1), "a::T");
}

// Whatever bytes a file holds: an answer or an error, no crash and no endless loop.
TEST(IdlSchemaTest, CutAndChangedTextsEndInAnAnswerOrAnError) {
  const std::string whole =
      "module a { /* [m] */ enum E { @value(3) A, B }; const long n = 2*(3+1); // [s]\n"
      "@final struct S { @key long x[n]; sequence<E, 3> y; string<n> z; }; union U { }; };";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    for (const char c : {'\0', '{', '(', '@', '"', ':', '<', '[', '*', '9'}) {
      std::string text = whole;
      text[length] = c;
      for (const std::string& candidate : {whole.substr(0, length) + c, text}) {
        try {
          (void)parse_idl(candidate, "F");
        } catch (const ConfigError&) {
        }
      }
    }
  }
  EXPECT_THAT(
      [] {
        (void)parse_idl(
            "struct A { " +
                [] {
                  std::string nested;
                  for (int i = 0; i < 100'000; ++i) nested += "sequence<";
                  return nested;
                }(),
            "F");
      },
      ThrowsMessage<ConfigError>(HasSubstr("fewer nested types")));
}

}  // namespace
}  // namespace stillhand::recording::omgidl_test
