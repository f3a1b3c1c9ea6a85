// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/refusal.hpp"

namespace stillhand::recording::csv_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string error_of(std::string_view text) {
  return support::refusal([&] { (void)parse_csv(text, "ride.csv"); });
}

TEST(CsvTest, ReadsColumnsWithNamesAndUnits) {
  const Recording sut = parse_csv("t [s],a_y [m/s^2],temp [degC]\n0,1.5,20\n0.01,-2e-3,21\n", "x");
  EXPECT_THAT(sut.time_s, ElementsAre(0.0, 0.01));
  ASSERT_EQ(sut.columns.size(), 2u);
  EXPECT_EQ(sut.columns[0].name, "a_y");
  EXPECT_EQ(sut.columns[0].unit, "m/s^2");
  EXPECT_THAT(sut.columns[0].values, ElementsAre(1.5, -2e-3));
  EXPECT_THAT(sut.find("temp")->values, ElementsAre(20.0, 21.0));
  EXPECT_EQ(sut.find("f"), nullptr);
  EXPECT_EQ(sut.source, "x");
}

TEST(CsvTest, AcceptsWhatSpreadsheetsWrite) {
  const Recording sut =
      parse_csv("\xEF\xBB\xBF\"t [s]\", \"f [N]\" \r\n 0 ,+1\r\n 0.5 ,\t2\r\n\r\n", "ride.csv");
  EXPECT_THAT(sut.find("f")->values, ElementsAre(1.0, 2.0));
  // A last line without an end.
  EXPECT_EQ(parse_csv("t [s],f [N]\n0,1\n1,2", "x").row_count(), 2u);
}

TEST(CsvTest, SaysWhatIsWrongWithTheHeader) {
  EXPECT_THAT(error_of(""), StartsWith("ride.csv:1:1: got an empty first line, want a header"));
  EXPECT_THAT(error_of("\nt [s],f [N]\n"), StartsWith("ride.csv:1:1: got an empty first line"));
  EXPECT_THAT(error_of("t [s],force\n"),
              StartsWith("ride.csv:1:7: got the column title 'force' without a unit"));
  EXPECT_THAT(error_of("t [s],force []\n"), HasSubstr("without dimension: '[-]'"));
  EXPECT_THAT(error_of("t [s], [N]\n"), StartsWith("ride.csv:1:8: got a unit without a name"));
  EXPECT_THAT(error_of("t [s],a_y [g]\n"),
              StartsWith("ride.csv:1:7: got 'a_y [g]', want 'a_y [m/s^2]'"));
  EXPECT_THAT(error_of("t [s],f [N],grip [N],f [N]\n"),
              StartsWith("ride.csv:1:22: got a second column 'f'"));
  EXPECT_THAT(error_of("f [N],t [s]\n"), StartsWith("ride.csv:1:1: got the first column 'f [N]'"));
  EXPECT_THAT(error_of("t [ms],f [N]\n"), StartsWith("ride.csv:1:1: got the first column"));
  EXPECT_THAT(error_of("t [s]\n0\n1\n"), HasSubstr("no column except the time"));
  EXPECT_THAT(error_of("t [s],,f [N]\n"), StartsWith("ride.csv:1:7: got an empty column title"));
  EXPECT_THAT(error_of("t [s];f [N]\n"), StartsWith("ride.csv:1:6: got ';' between columns"));
}

TEST(CsvTest, SaysWhereARowIsWrong) {
  const std::string header = "t [s],f [N]\n";
  EXPECT_THAT(error_of(header + "0,1\n1\n"),
              StartsWith("ride.csv:3:2: got a row of 1 cells, want 2"));
  EXPECT_THAT(error_of(header + "0,1\n1,2,3\n"),
              StartsWith("ride.csv:3:4: got more than 2 cells, want 2"));
  EXPECT_THAT(error_of(header + "0,1\n1,two\n"),
              StartsWith("ride.csv:3:3: got 'two', want a finite number in column 'f [N]'"));
  EXPECT_THAT(error_of(header + "0,1\n1,2x\n"), StartsWith("ride.csv:3:3: got '2x'"));
  EXPECT_THAT(error_of(header + "0,1\n1,\n"), StartsWith("ride.csv:3:3: got an empty cell"));
  EXPECT_THAT(error_of(header + "0,1\n1,NaN\n"), StartsWith("ride.csv:3:3: got 'NaN'"));
  EXPECT_THAT(error_of(header + "0,1\n1,-inf\n"), StartsWith("ride.csv:3:3: got '-inf'"));
  EXPECT_THAT(error_of(header + "0,1\n1,1e999\n"), StartsWith("ride.csv:3:3: got '1e999'"));
  EXPECT_THAT(error_of(header + "0,1\n1,0x10\n"), StartsWith("ride.csv:3:3: got '0x10'"));
  EXPECT_THAT(error_of(header + "0,1\n1,+-2\n"), StartsWith("ride.csv:3:3: got '+-2'"));
  EXPECT_THAT(error_of(header + "0,1\n\n1,2\n"), StartsWith("ride.csv:3:1: got an empty line"));
  EXPECT_THAT(error_of(header + "0,1\n0,2\n"),
              StartsWith("ride.csv:3:1: got time 0 s, want more than 0 s"));
  EXPECT_THAT(error_of(header + "0,1\n0.5,2\n0.25,2\n"),
              StartsWith("ride.csv:4:1: got time 0.25 s, want more than 0.5 s"));
  EXPECT_THAT(error_of(header), HasSubstr("got 0 rows, want at least 2"));
  EXPECT_THAT(error_of(header + "0,1\n"), HasSubstr("got 1 rows, want at least 2"));
}

TEST(CsvTest, RowsThatARecorderWroteTwiceAreLeftOut) {
  const std::string rows = "t [s],f [N],g [N]\n0,1,5\n1,2,6\n0,1,5\n1,2,6\n";
  const Recording sut = parse_csv(rows + "2,3,7\n", "x");
  EXPECT_THAT(sut.time_s, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_EQ(sut.repeated_rows, 2u);
  EXPECT_THAT(error_of(rows + "0,1,6\n"), HasSubstr("got time 0 s, want more than 1 s"));
}

TEST(CsvTest, KeepsALongWrongCellShort) {
  const std::string error = error_of("t [s],f [N]\n0," + std::string(100'000, 'x') + "\n");
  EXPECT_LT(error.size(), 200u);
  EXPECT_THAT(error, HasSubstr("got '" + std::string(40, 'x') + "...', want"));
}

TEST(CsvTest, NeverReadsOutsideItsText) {
  // Every prefix, and random bytes over it; run with the address sanitizer this finds overruns.
  const std::string whole = "t [s],f [N],grip [N]\r\n0,1.25,2\r\n0.01,-1e3,+2\r\n0.02,1,1\r\n";
  std::mt19937 random(3);
  const std::string letters = ",;[]\"\r\n +-.eE0n\xEF";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    for (int round = 0; round < 200; ++round) {
      std::vector<char> exact(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      for (std::size_t i = 0; i < exact.size() && i < static_cast<std::size_t>(round % 4); ++i) {
        exact[random() % exact.size()] = letters[random() % letters.size()];
      }
      (void)error_of({exact.data(), exact.size()});
    }
  }
}

TEST(CsvTest, WritesWhatItReadsBackBitForBit) {
  Recording recording;
  recording.columns = {{"a_y", "m/s^2", {}}, {"grip", "N", {}}};
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, 1e3);
  for (int row = 0; row < 1000; ++row) {
    recording.time_s.push_back(row * 1e-3);
    recording.columns[0].values.push_back(normal(random));
    recording.columns[1].values.push_back(normal(random) * 1e-300);
  }
  const Recording sut = parse_csv(to_csv(recording), "x");
  EXPECT_EQ(sut.time_s, recording.time_s);
  EXPECT_EQ(sut.columns[0].values, recording.columns[0].values);
  EXPECT_EQ(sut.columns[1].values, recording.columns[1].values);
  EXPECT_EQ(sut.columns[1].unit, "N");
}

TEST(CsvTest, WhatIsNoTextIsRefusedInOneLine) {
  EXPECT_THAT(error_of(std::string_view("t\0 [\0s\0]\0", 9)), HasSubstr("got binary data"));
  const std::string error = error_of("\x89M\rC\nt [s],f [N]\n");
  EXPECT_THAT(error, HasSubstr("M?C'"));
  EXPECT_EQ(error.find_first_of("\r\n\x1b"), std::string::npos);
}

}  // namespace
}  // namespace stillhand::recording::csv_test
