// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/xdf_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"
#include "tests/unit/measurement/foreign_bytes.hpp"

namespace stillhand::measurement::xdf_table_test {

using made::packed;
using made::xdf_chunk;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::uint8_t kOne = 1;
constexpr std::uint8_t kEight = 8;

std::string header(std::uint32_t id, const std::string& format, int channels = 1,
                   const std::string& rest = {}) {
  return xdf_chunk(2, packed(id) + "<info><name>s</name><channel_count>" +
                          std::to_string(channels) + "</channel_count><channel_format>" + format +
                          "</channel_format>" + rest + "</info>");
}

// One row with a stamp.
template <typename... Values>
std::string row(std::uint32_t id, double time_s, const Values&... values) {
  return xdf_chunk(3, packed(id, kOne, kOne, kEight, time_s, values...));
}

std::unique_ptr<TableFile> table(const std::string& chunks, std::size_t most_values = 1000) {
  return xdf_table("XDF:" + chunks, "f.xdf", most_values);
}

std::string refused(const std::string& chunks, std::size_t most_values = 1000) {
  return support::refusal([&] { (void)table(chunks, most_values); });
}

TEST(XdfTableTest, EveryTypeOfNumberIsRead) {
  const auto value = [](const std::string& format, auto number) {
    return table(header(1, format) + row(1, 5.0, number))->read({0}).values.at(0).at(0);
  };
  EXPECT_EQ(value("double64", -1.5), -1.5);
  EXPECT_EQ(value("float32", -1.5F), -1.5);
  EXPECT_EQ(value("int8", std::int8_t{-3}), -3.0);
  EXPECT_EQ(value("int16", std::int16_t{-3}), -3.0);
  EXPECT_EQ(value("int32", std::int32_t{-3}), -3.0);
  EXPECT_EQ(value("int64", std::int64_t{-3}), -3.0);
  EXPECT_THAT(refused(header(1, "string") + row(1, 5.0, kOne)), HasSubstr("no samples of numbers"));
}

TEST(XdfTableTest, ChannelsHaveTheirLabelsAndUnits) {
  const std::string described =
      "<channels><channel><label>a</label><unit>N</unit></channel>"
      "<channel><unit>V</unit></channel></channels>";
  const auto sut = table(header(1, "int8", 3, described) + row(1, 5.0, kOne, kOne, kOne));
  const TableHead& head = sut->head();
  ASSERT_EQ(head.columns.size(), 3U);
  EXPECT_EQ(head.columns[0].title + " " + head.columns[0].unit, "s.a N");
  EXPECT_EQ(head.columns[1].title + " " + head.columns[1].unit, "s.2 V");
  EXPECT_EQ(head.columns[2].title + " " + head.columns[2].unit, "s.3 ");
  EXPECT_EQ(head.columns[0].rows, 1U);
  EXPECT_TRUE(head.has_times);
  EXPECT_EQ(head.form, "XDF");
  EXPECT_THAT(head.notes, ElementsAre());
  const auto shared = table(header(1, "int8") + row(1, 5.0, kOne) + header(2, "int8") +
                            row(2, 5.0, kOne) + header(3, "int8"));
  ASSERT_EQ(shared->head().columns.size(), 2U);  // the third stream has no row
  EXPECT_EQ(shared->head().columns[0].title, "s 1.1");
  EXPECT_EQ(shared->head().columns[1].title, "s 2.1");
}

// A row without a stamp follows the row before it by the nominal period.
TEST(XdfTableTest, RowsGoOnAtTheNominalRate) {
  const std::uint8_t none = 0;
  const std::uint8_t three = 3;
  const std::uint32_t id = 1;
  const std::string rows = xdf_chunk(3, packed(id, kOne, three, kEight, 7.0, std::int8_t{4}, none,
                                               std::int8_t{5}, none, std::int8_t{6}));
  const auto sut = table(header(1, "int8", 1, "<nominal_srate>4</nominal_srate>") + rows);
  const RawColumns read = sut->read({0});
  EXPECT_THAT(read.time_s, ElementsAre(0.0, 0.25, 0.5));
  EXPECT_THAT(read.values.at(0), ElementsAre(4.0, 5.0, 6.0));
  // Of a stream without a rate they do not go on.
  EXPECT_THAT(support::refusal([&] { (void)table(header(1, "int8") + rows)->read({0}); }),
              HasSubstr("time stamps of 's' that do not go on"));
}

TEST(XdfTableTest, AChunkThatContradictsItselfIsRefusedWithItsPlace) {
  const std::string good = header(1, "int8") + row(1, 5.0, kOne);
  const std::string place = "f.xdf, byte " + std::to_string(4 + good.size());
  const std::uint32_t id = 1;
  const auto error = [&](const std::string& chunk, std::size_t most_values = 1000) {
    const std::string words = refused(good + chunk, most_values);
    return words.starts_with(place + ":") ? "refused" : words;
  };
  EXPECT_EQ(error(header(1, "int8")), "refused") << "the stream is there";
  EXPECT_EQ(error(row(2, 6.0, kOne)), "refused") << "and this one is not";
  EXPECT_EQ(error(header(2, "int8", 0)), "refused") << "no channel";
  EXPECT_EQ(error(header(2, "int8", 1, std::string(1 << 20, ' '))), "refused") << "too long";
  EXPECT_EQ(error(xdf_chunk(3, packed(id, kOne, kOne, kOne, 6.0, kOne))), "refused")
      << "a stamp of one byte";
  EXPECT_EQ(error(xdf_chunk(3, packed(id, std::uint8_t{2}, kOne))), "refused")
      << "a number of rows in two bytes";
  EXPECT_EQ(error(xdf_chunk(3, packed(id, kOne, kOne, kEight, 6.0))), "refused") << "no value";
  EXPECT_EQ(error(xdf_chunk(4, packed(id, 1e10, 0.0))), "refused");
  EXPECT_EQ(error(xdf_chunk(4, packed(id, 0.0, -1e10))), "refused");
  EXPECT_EQ(error(row(1, 6.0, kOne), 1), "refused") << "more values than may be read";
  EXPECT_EQ(error(row(1, 6.0, kOne), 2), "accepted");
  EXPECT_EQ(error(xdf_chunk(4, packed(id, 9e9, -9e9))), "accepted");
  EXPECT_EQ(error(xdf_chunk(5, "a chunk of another kind")), "accepted");
  EXPECT_EQ(error(xdf_chunk(1, "a chunk of another kind")), "accepted");
}

TEST(XdfTableTest, WhatTheEndCutsOffIsLeftOut) {
  const std::string good = header(1, "int8") + row(1, 5.0, kOne);
  const std::string more = row(1, 6.0, kOne);
  for (std::size_t left = 1; left < more.size(); ++left) {
    const auto sut = table(good + more.substr(0, left));
    EXPECT_EQ(sut->head().columns.at(0).rows, 1U);
    EXPECT_EQ(sut->head().notes.at(0), "The file is cut off: " + std::to_string(4 + good.size()) +
                                           " of " + std::to_string(4 + good.size() + left) +
                                           " bytes are read.");
  }
}

// Numbers of rows in one, four and eight bytes.
TEST(XdfTableTest, ALengthHasItsOwnLength) {
  const std::uint32_t id = 1;
  const auto rows = [&](auto... count) {
    return table(header(1, "int8") +
                 xdf_chunk(3, packed(id, count..., kEight, 7.0, kOne, kEight, 8.0, kOne)))
        ->head()
        .columns.at(0)
        .rows;
  };
  EXPECT_EQ(rows(kOne, std::uint8_t{2}), 2U);
  EXPECT_EQ(rows(std::uint8_t{4}, std::uint32_t{2}), 2U);
  EXPECT_EQ(rows(kEight, std::uint64_t{2}), 2U);
}

// Rows of a stream at 100 Hz, with their stamps off by `late_s(i)`, and a clock offset each second.
std::string stream(std::uint32_t id, int rows, auto late_s, auto offset_s) {
  std::string out = header(id, "double64", 1, "<nominal_srate>100</nominal_srate>");
  for (int i = 0; i < rows; ++i) {
    const double at_s = 10.0 + 0.01 * i;
    out += row(id, at_s + late_s(i), 1.0 * i);
    if (i % 100 == 0) out += xdf_chunk(4, packed(id, at_s, offset_s(i / 100)));
  }
  return out;
}

double none(int /*i*/) { return 0.0; }

// Eq. ME-18: times of the recorder are those of the sender, and the line of the offsets.
TEST(XdfTableTest, AStreamIsPutOnTheRecordersClock) {
  const auto drifting = [](int k) { return 0.25 + 0.125 * k; };
  const RawColumns alone = table(stream(1, 400, none, drifting))->read({0});
  EXPECT_NEAR(alone.time_s[100], 1.125, 1e-12);
  const auto two =
      table(stream(1, 400, none, none) + stream(2, 400, none, [](int) { return 0.5; }));
  const RawColumns read = two->read({0, 1});
  EXPECT_NEAR(read.values[1][100], 50.0, 1e-9);  // half a second before
  EXPECT_THAT(read.notes, ElementsAre("Values of s 2 are taken at the times of s 1, by a cubic "
                                      "between its rows."));
  const auto without = table(stream(1, 400, none, none) + header(2, "int8") + row(2, 10.0, kOne));
  EXPECT_THAT(support::refusal([&] { (void)without->read({0, 1}); }),
              HasSubstr("no clock offsets of 's 2'"));
}

// More than a tenth of them.
TEST(XdfTableTest, OffsetsThatLeaveTheirLineAreRefused) {
  const auto jumps = [](double by_s, int how_many) {
    return support::refusal([&] {
      (void)table(stream(1, 2000, none, [&](int k) { return k < how_many ? by_s : 0.0; }), 5000)
          ->read({0});
    });
  };
  EXPECT_EQ(jumps(0.0021, 2), "accepted");
  EXPECT_THAT(jumps(0.0021, 3), HasSubstr("3 of 20 clock offsets of 's' that leave their line"));
  EXPECT_EQ(jumps(0.0019, 3), "accepted");
}

// Eq. ME-20: 200 rows at least, within 2 ms on the mean of each eighth, at the nominal rate.
TEST(XdfTableTest, StampsThatOverlapAreSpreadEvenly) {
  const auto read = [](int rows, auto late_s) {
    std::vector<double> time_s;
    const std::string error = support::refusal(
        [&] { time_s = table(stream(1, rows, late_s, none), 5000)->read({0}).time_s; });
    return error == "accepted" ? time_s : std::vector<double>{};
  };
  const auto overlaps = [](int i) { return i % 2 == 0 ? 0.006 : -0.006; };
  const std::vector<double> sut = read(200, overlaps);
  ASSERT_EQ(sut.size(), 200U);
  // The slope of stamps that alternate by a is off by 6 a / n^2, with n = 200 rows.
  double even_s = 0.0;
  for (const double each_s : sut) {
    EXPECT_NEAR(each_s, even_s, 200 * 6 * 0.006 / 40000);
    even_s += 0.01;
  }
  EXPECT_EQ(read(199, overlaps).size(), 0U);
  // A bow of the stamps: its means are within 2 ms or not.
  const auto bow = [&](double deep_s) {
    return [=](int i) {
      const double x = i / 399.5 - 0.5;
      return overlaps(i) + deep_s * (x * x - 1.0 / 12.0);
    };
  };
  EXPECT_EQ(read(400, bow(0.014)).size(), 400U);
  EXPECT_EQ(read(400, bow(0.020)).size(), 0U);
  const auto fast = [&](double by) { return [=](int i) { return overlaps(i) + by * 0.01 * i; }; };
  EXPECT_EQ(read(400, fast(0.0049)).size(), 400U);
  EXPECT_EQ(read(400, fast(0.0052)).size(), 0U);
  // Two stretches with a jump of more than a second, each on a line of its own.
  const auto jump = [&](double by_s) {
    return [=](int i) { return overlaps(i) + (i < 400 ? 0.0 : by_s); };
  };
  const std::vector<double> two = read(800, jump(1.5));
  ASSERT_EQ(two.size(), 800U);
  EXPECT_NEAR(two[400] - two[399], 1.51, 1e-4);
  EXPECT_EQ(read(800, jump(0.9)).size(), 0U);
}

}  // namespace stillhand::measurement::xdf_table_test
