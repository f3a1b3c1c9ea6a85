// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::mapping_test {

using testing::HasSubstr;

std::string error_of(const std::function<void()>& call) {
  return support::refusal([&] { call(); });
}

std::string file_of(const std::string& text) {
  std::string path = testing::TempDir() + "mapping.yaml";
  std::ofstream(path) << text;
  return path;
}

TEST(MappingTest, ReadsTitleChannelUnitAndGain) {
  const ColumnWish plain = parse_wish("time=t [s]");
  EXPECT_EQ(plain.from, "time");
  EXPECT_EQ(plain.name, "t");
  EXPECT_EQ(plain.unit, "s");
  const ColumnWish gain = parse_wish("ai0 [V] = f [V] / 22.5 [mV/N]");
  EXPECT_EQ(gain.from, "ai0 [V]");
  EXPECT_EQ(gain.gain.number, 22.5);
  EXPECT_TRUE(gain.gain.divides);
  EXPECT_EQ(gain.gain.unit, "mV/N");
  EXPECT_EQ(parse_wish("acc=a_y*9.81").gain.number, 9.81);
  EXPECT_EQ(parse_wish("a=b=a_y").from, "a=b") << "a title may hold '='";
  EXPECT_EQ(parse_wish("x = 3 [m]=x_p").from, "x = 3 [m]");
  EXPECT_EQ(parse_wish("force=F [N]").name, "f") << "the case of a known name does not matter";
  EXPECT_EQ(parse_wish("grip=Grip").name, "Grip");
}

TEST(MappingTest, AWrongWishIsRefusedWithAnExample) {
  for (const char* wrong : {"", "time", "=t", "time=", "time=t [s", "time=t []", "time=t * x",
                            "time=t * 0", "time=t + 3", "time=t * inf", "time=\"t\"", "a=b c"}) {
    EXPECT_THAT(error_of([&] { parse_wish(wrong); }), HasSubstr("'acc=a_y [m/s^2]'")) << wrong;
  }
}

TEST(MappingTest, ATitleOfSeveralLinesIsRefused) {
  for (const char* wrong : {"a\n\nb=f [N]", "a\x01=f [N]", "a\x7f=f"}) {
    EXPECT_THAT(error_of([&] { parse_wish(wrong); }), HasSubstr("'#2=f [N]'")) << wrong;
  }
  EXPECT_EQ(parse_wish("a\tb=f [N]").from, "a\tb");
}

TEST(MappingTest, AFileGivesTheSameMappingAgain) {
  Mapping mapping;
  for (const char* wish :
       {"time=t [ms]", "it's=a_y [g]", "#3=f [V] * 22.5 [N/V]", "p q=grip [%] / 3"}) {
    mapping.columns.push_back(parse_wish(wish));
  }
  mapping.rate_hz = 0.1;
  mapping.form = {'\t', ','};
  const Mapping sut = read_mapping(file_of(mapping_yaml(mapping, "ride.csv")));
  ASSERT_EQ(sut.columns.size(), mapping.columns.size());
  for (std::size_t i = 0; i < sut.columns.size(); ++i) {
    EXPECT_EQ(wish_text(sut.columns[i]), wish_text(mapping.columns[i]));
  }
  EXPECT_EQ(sut.rate_hz, 0.1);
  EXPECT_EQ(sut.form.separator, '\t');
  EXPECT_EQ(sut.form.decimal, ',');
}

TEST(MappingTest, AWrongFileIsRefusedWithItsPlace) {
  const auto refusal = [](const std::string& text) {
    return error_of([&] { read_mapping(file_of(text)); });
  };
  EXPECT_THAT(refusal("map: 3\n"), HasSubstr("mapping.yaml:1:6: mapping.map: got 3"));
  EXPECT_THAT(refusal("map:\n  - time\n"), HasSubstr("mapping.yaml:2:5: mapping.map: got 'time'"));
  EXPECT_THAT(refusal("map:\n  - {a: b}\n"), HasSubstr("got a map"));
  EXPECT_THAT(refusal("rate_hz: 0\n"), HasSubstr("rate in Hz"));
  EXPECT_THAT(refusal("separator: x\n"), HasSubstr("comma, semicolon, tab or blank"));
  EXPECT_THAT(refusal("decimal: x\n"), HasSubstr("point or comma"));
  EXPECT_THAT(refusal("columns: []\n"), HasSubstr("columns"));
}

}  // namespace stillhand::measurement::mapping_test
