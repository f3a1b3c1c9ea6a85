// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/tdms_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/refusal.hpp"
#include "tests/unit/measurement/foreign_bytes.hpp"

namespace stillhand::measurement::tdms_table_test {

using namespace std::string_literals;
using made::packed;
using made::Tdms;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint32_t kMeta = 2;
constexpr std::uint32_t kNewList = 4;
constexpr std::uint32_t kRaw = 8;
constexpr std::uint32_t kInterleaved = 32;
constexpr std::uint32_t kDouble = 10;
constexpr std::uint32_t kByte = 5;  // without a sign

// Metadata of `objects` objects in the byte order of this machine.
Tdms meta(std::uint32_t objects) { return Tdms(false).add(objects); }

std::unique_ptr<TableFile> table(const std::string& bytes, std::size_t most_values = 1000) {
  return tdms_table(bytes, "f.tdms", most_values);
}

std::vector<double> values(const std::string& bytes, std::size_t column = 0) {
  return table(bytes)->read({column}).values.at(0);
}

// Without the line that makes a CSV of the file.
std::string refused(const std::string& bytes, const std::vector<std::size_t>& columns = {0},
                    std::size_t most_values = 1000) {
  const std::string error =
      support::refusal([&] { (void)table(bytes, most_values)->read(columns); });
  return error.substr(0, error.find("; or a CSV"));
}

// One channel with these numbers of one type.
template <typename... Values>
std::string channel(std::uint32_t type, const Values&... numbers) {
  return meta(1)
      .object("/'g'/'a'", type, sizeof...(numbers), 0)
      .segment(kMeta | kRaw, packed(numbers...));
}

TEST(TdmsTableTest, EveryTypeOfNumberIsReadInEitherOrderOfBytes) {
  EXPECT_THAT(values(channel(1, std::int8_t{-3}, std::int8_t{127})), ElementsAre(-3.0, 127.0));
  EXPECT_THAT(values(channel(2, std::int16_t{-3})), ElementsAre(-3.0));
  EXPECT_THAT(values(channel(3, std::int32_t{-3})), ElementsAre(-3.0));
  EXPECT_THAT(values(channel(4, std::int64_t{-3})), ElementsAre(-3.0));
  EXPECT_THAT(values(channel(5, std::uint8_t{253})), ElementsAre(253.0));
  EXPECT_THAT(values(channel(6, std::uint16_t{65533})), ElementsAre(65533.0));
  EXPECT_THAT(values(channel(7, std::uint32_t{4294967293})), ElementsAre(4294967293.0));
  EXPECT_THAT(values(channel(8, std::uint64_t{1} << 63)), ElementsAre(9223372036854775808.0));
  EXPECT_THAT(values(channel(9, -1.5F)), ElementsAre(-1.5));
  EXPECT_THAT(values(channel(10, -1.5)), ElementsAre(-1.5));
  EXPECT_THAT(values(channel(0x19, -1.5F)), ElementsAre(-1.5)) << "with a unit";
  EXPECT_THAT(values(channel(0x1A, -1.5)), ElementsAre(-1.5)) << "with a unit";
  EXPECT_THAT(values(channel(0x21, std::uint8_t{1})), ElementsAre(1.0)) << "a Boolean";
  for (const std::uint32_t type : {11u, 0x18u, 0x1Bu, 0x22u, 0x43u}) {
    EXPECT_THAT(refused(channel(type, 0.0)), HasSubstr("of 'g.a'")) << type;
  }
  Tdms swapped(true);
  swapped.add(std::uint32_t{1}).object("/'g'/'a'", kDouble, 2, 0);
  EXPECT_THAT(values(swapped.segment(kMeta | kRaw, Tdms(true).add(-1.5).add(2.5).bytes())),
              ElementsAre(-1.5, 2.5));
}

TEST(TdmsTableTest, ATitleIsGroupAndChannelAndAUnitStands) {
  Tdms sut = meta(3);
  sut.object("/'it''s'/'a b'", kByte, 1, 1).words("unit_string", "N");
  sut.object("/'g'/'b'", kByte, 1, 1).words("NI_UnitDescription", "V");
  sut.object("/'g'/'c'/'d'", kByte, 1, 0);
  const auto read = table(sut.segment(kMeta | kRaw, "abc"));
  const TableHead& head = read->head();
  ASSERT_EQ(head.columns.size(), 3U);
  EXPECT_EQ(head.columns[0].title + " " + head.columns[0].unit, "it's.a b N");
  EXPECT_EQ(head.columns[1].title + " " + head.columns[1].unit, "g.b V");
  EXPECT_EQ(head.columns[2].title, "/'g'/'c'/'d'");
  EXPECT_EQ(head.form, "TDMS");
  EXPECT_FALSE(head.has_times);
  EXPECT_EQ(support::refusal([] { (void)table(""); }),
            "f.tdms: got no samples of numbers, want a TDMS file with some");
}

// Columns one behind the other, again for each chunk, or row by row; a text is passed over.
TEST(TdmsTableTest, RawDataAreColumnsOrRows) {
  Tdms two = meta(2);
  two.object("/'g'/'a'", kByte, 2, 0).object("/'g'/'b'", kByte, 2, 0);
  EXPECT_THAT(values(two.segment(kMeta | kRaw, "abcdefgh"), 0), ElementsAre('a', 'b', 'e', 'f'));
  EXPECT_THAT(values(two.segment(kMeta | kRaw, "abcdefgh"), 1), ElementsAre('c', 'd', 'g', 'h'));
  const std::string rows = two.segment(kMeta | kRaw | kInterleaved, "abcd");
  EXPECT_THAT(values(rows, 0), ElementsAre('a', 'c'));
  EXPECT_THAT(values(rows, 1), ElementsAre('b', 'd'));
  Tdms text = meta(2);
  text.text("/'g'/'t'").add(std::uint32_t{28}).add(std::uint32_t{0x20}).add(std::uint32_t{1});
  text.add(std::uint64_t{1}).add(std::uint64_t{3}).add(std::uint32_t{0});
  text.object("/'g'/'a'", kByte, 2, 0);
  EXPECT_THAT(values(text.segment(kMeta | kRaw, "xyzab")), ElementsAre('a', 'b'));
  EXPECT_THAT(refused(text.segment(kMeta | kRaw | kInterleaved, "xyzab")), HasSubstr("byte 0"));
  Tdms uneven = meta(2);
  uneven.object("/'g'/'a'", kByte, 2, 0).object("/'g'/'b'", kByte, 1, 0);
  EXPECT_THAT(refused(uneven.segment(kMeta | kRaw | kInterleaved, "abc")), HasSubstr("byte 0"));
  EXPECT_EQ(refused(uneven.segment(kMeta | kRaw, "abc"), {0, 1}),
            "f.tdms: got columns of 2 and 1 rows, want channels of one length, or with "
            "wf_increment");
}

// A segment names what is new in it: an object "as before", one without raw data from now on, a new
// list.
TEST(TdmsTableTest, ASegmentGoesOnFromTheOneBefore) {
  const auto object = [](Tdms& to, const std::string& path, std::uint32_t index) {
    to.text(path).add(index).add(std::uint32_t{0});
  };
  Tdms first = meta(2);
  first.object("/'g'/'a'", kByte, 1, 0).object("/'g'/'b'", kByte, 1, 0);
  const std::string begun = first.segment(kMeta | kRaw, "ab");
  EXPECT_THAT(values(begun + meta(0).segment(kRaw, "cd")), ElementsAre('a', 'c'));
  Tdms same = meta(1);
  object(same, "/'g'/'b'", 0);
  EXPECT_THAT(values(begun + same.segment(kMeta | kRaw, "cd"), 1), ElementsAre('b', 'd'));
  EXPECT_THAT(values(begun + same.segment(kMeta | kRaw | kNewList, "cd"), 1),
              ElementsAre('b', 'c', 'd'));
  Tdms without = meta(1);
  object(without, "/'g'/'a'", 0xFFFFFFFF);
  EXPECT_THAT(values(begun + without.segment(kMeta | kRaw, "cd"), 1), ElementsAre('b', 'c', 'd'));
  Tdms unknown = meta(1);
  object(unknown, "/'g'/'c'", 0);
  EXPECT_THAT(refused(begun + unknown.segment(kMeta | kRaw, "cd")),
              HasSubstr("contradicts itself"));
  Tdms other_type = meta(1);
  other_type.object("/'g'/'a'", kDouble, 1, 0);
  EXPECT_THAT(refused(begun + other_type.segment(kMeta | kRaw, "cdefghijk")),
              HasSubstr("byte " + std::to_string(begun.size())));
  EXPECT_THAT(refused(begun + meta(0).segment(kRaw | kNewList | kMeta, "cd")),
              HasSubstr("contradicts itself"))
      << "raw data of nothing";
}

TEST(TdmsTableTest, WhatTheEndCutsOffIsReadAsFarAsItGoes) {
  const auto cut = [&](std::size_t bytes) {
    const std::string more = meta(0).segment(kRaw, "abcdefgh");
    return table(channel(5, std::uint8_t{1}, std::uint8_t{2}) + more.substr(0, bytes));
  };
  EXPECT_EQ(cut(0)->head().notes.size(), 0U);
  EXPECT_EQ(cut(27)->head().notes.at(0),
            "The file is cut off: its last segment is read as far as it goes.");
  EXPECT_EQ(cut(27)->head().columns[0].rows, 2U);
  EXPECT_EQ(cut(31)->head().columns[0].rows, 2U);  // in the metadata
  EXPECT_EQ(cut(32 + 3)->head().columns[0].rows, 5U);
  EXPECT_EQ(cut(32 + 8)->head().columns[0].rows, 10U);
  EXPECT_EQ(cut(32 + 8)->head().notes.size(), 0U);
  std::string wrong = meta(0).segment(kRaw, "ab");
  wrong[0] = 'X';
  EXPECT_THAT(refused(channel(5, std::uint8_t{1}) + wrong), HasSubstr("contradicts itself"));
  // More than may be read, and objects beyond 1024.
  const std::string three = channel(5, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{3});
  EXPECT_THAT(refused(three, {0}, 2), HasSubstr("too many values"));
  EXPECT_EQ(refused(three, {0}, 3), "accepted");
  for (const std::uint32_t count : {1024u, 1025u}) {
    Tdms many = meta(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      many.object("/'g'/'" + std::to_string(i) + "'", kByte, i == 0 ? 1 : 0, 0);
    }
    EXPECT_EQ(refused(many.segment(kMeta | kRaw, "a")) == "accepted", count == 1024);
  }
}

// Properties of the first of two channels of bytes, "ab" and "cd".
std::string with_properties(std::uint32_t count, const std::function<void(Tdms&)>& add) {
  Tdms sut = meta(2);
  sut.object("/'g'/'a'", kByte, 2, count);
  add(sut);
  sut.object("/'g'/'b'", kByte, 2, 1).number("wf_increment", 0.5);
  return sut.segment(kMeta | kRaw, "abcd");
}

void linear(Tdms& to, const std::string& number, double slope, double intercept) {
  to.words("NI_Scale[" + number + "]_Scale_Type", "Linear");
  to.number("NI_Scale[" + number + "]_Linear_Slope", slope);
  to.number("NI_Scale[" + number + "]_Linear_Y_Intercept", intercept);
}

// The last scale takes the one before it: 2 (3 x + 10) + 100.
TEST(TdmsTableTest, ScalesAreAChainOfLines) {
  EXPECT_THAT(values(with_properties(8,
                                     [](Tdms& to) {
                                       to.whole("NI_Number_Of_Scales", 2);
                                       linear(to, "0", 3.0, 10.0);
                                       linear(to, "1", 2.0, 100.0);
                                       to.whole("NI_Scale[1]_Linear_Input_Source", 0);
                                     })),
              ElementsAre(6.0 * 'a' + 120.0, 6.0 * 'b' + 120.0));
  EXPECT_THAT(refused(with_properties(8,
                                      [](Tdms& to) {
                                        to.whole("NI_Number_Of_Scales", 2);
                                        linear(to, "0", 3.0, 10.0);
                                        linear(to, "1", 2.0, 100.0);
                                        to.whole("NI_Scale[1]_Linear_Input_Source", 1);
                                      })),
              HasSubstr("got scales in a circle of 'g.a', want linear scales"));
  EXPECT_THAT(refused(with_properties(
                  2,
                  [](Tdms& to) {
                    to.whole("NI_Number_Of_Scales", 1).words("NI_Scale[0]_Scale_Type", "Table");
                  })),
              HasSubstr("got a scale 'Table' of 'g.a'"));
  const auto status = [](const std::string& words) {
    return refused(with_properties(5, [&](Tdms& to) {
      to.whole("NI_Number_Of_Scales", 1).words("NI_Scaling_Status", words);
      linear(to, "0", 3.0, 10.0);
    }));
  };
  EXPECT_EQ(status("unscaled"), "accepted");
  EXPECT_THAT(status("scaled"), HasSubstr("got values 'scaled' with scales of 'g.a'"));
}

// Those of the channel's group, and else of the file.
TEST(TdmsTableTest, AChannelWithoutScalesHasThoseAroundIt) {
  const auto scaled = [](std::vector<std::pair<std::string, double>> around) {
    Tdms sut = meta(static_cast<std::uint32_t>(around.size()) + 1);
    for (const auto& [path, slope] : around) {
      sut.text(path).add(std::uint32_t{0xFFFFFFFF}).add(std::uint32_t{4});
      sut.whole("NI_Number_Of_Scales", 1);
      linear(sut, "0", slope, 0.0);
    }
    sut.object("/'g'/'a'", kByte, 1, 0);
    return values(sut.segment(kMeta | kRaw, "\1")).at(0);
  };
  EXPECT_EQ(scaled({}), 1.0);
  EXPECT_EQ(scaled({{"/", 2.0}}), 2.0);
  EXPECT_EQ(scaled({{"/", 2.0}, {"/'g'", 3.0}}), 3.0);
  EXPECT_EQ(scaled({{"/'h'", 3.0}}), 1.0);
}

TEST(TdmsTableTest, RowsWithOtherTimesAreTakenAtThoseOfTheFirst) {
  Tdms sut = meta(2);
  sut.object("/'g'/'a'", kByte, 4, 2).number("wf_increment", 0.5).number("wf_start_offset", 1.0);
  sut.object("/'g'/'b'", kByte, 4, 1).number("wf_increment", 0.5);
  const auto read = table(sut.segment(kMeta | kRaw, "\4\5\6\7\0\1\2\3"s))->read({0, 1});
  EXPECT_THAT(read.time_s, ElementsAre(0.0, 0.5, 1.0, 1.5));
  EXPECT_EQ(read.values[1][0], 2.0);
  EXPECT_EQ(read.values[1][1], 3.0);
  EXPECT_THAT(read.notes, ElementsAre("Values of g.b are taken at the times of g.a, by a cubic "
                                      "between its rows."));
}

// A stamp: seconds since 1904 and 2^-64 of them; of two recordings the second begins 10.25 s later.
TEST(TdmsTableTest, ARecordingThatWentOnHasATimeOfItsOwn) {
  const auto segment = [](bool big_endian, std::uint64_t start_s, std::uint64_t part) {
    Tdms sut(big_endian);
    sut.add(std::uint32_t{1}).object("/'g'/'a'", kByte, 2, 2).number("wf_increment", 0.5);
    sut.text("wf_start_time").add(std::uint32_t{0x44});
    big_endian ? sut.add(start_s).add(part) : sut.add(part).add(start_s);
    return sut.segment(kMeta | kRaw, "ab");
  };
  for (const bool big_endian : {false, true}) {
    const std::string both = segment(big_endian, 3'800'000'000, 0) +
                             segment(big_endian, 3'800'000'010, std::uint64_t{1} << 62);
    EXPECT_THAT(table(both)->read({0}).time_s, ElementsAre(0.0, 0.5, 10.25, 10.75));
    const std::string back =
        segment(big_endian, 3'800'000'000, 0) + segment(big_endian, 3'800'000'000, 0);
    EXPECT_THAT(table(back)->read({0}).time_s, ElementsAre(0.0, 0.5, 1.0, 1.5)) << "it goes on";
    EXPECT_THAT(
        refused(segment(big_endian, 3'800'000'001, 0) + segment(big_endian, 3'800'000'000, 0)),
        HasSubstr("times of 'g.a' that do not go on"));
  }
}

TEST(TdmsTableTest, RawDataOfAnotherProgramAreRefused) {
  for (const std::uint32_t index : {0x1269u, 0x1369u}) {
    Tdms sut = meta(1);
    sut.text("/'g'/'a'").add(index).add(std::uint32_t{0});
    EXPECT_THAT(refused(sut.segment(kMeta, "")), HasSubstr("DAQmx raw data"));
  }
  EXPECT_THAT(refused(meta(0).segment(128, "")), HasSubstr("DAQmx raw data"));
}

}  // namespace stillhand::measurement::tdms_table_test
