// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_cells.hpp"

#include <gtest/gtest.h>

#include <string>

namespace stillhand::measurement::text_cells_test {

// What a cell holds, for one line of a failure.
std::string read(std::string_view cell, char decimal = '.') {
  double number = 0.0;
  switch (read_cell(cell, decimal, number)) {
    case CellContent::kNumber:
      return std::to_string(number);
    case CellContent::kMissing:
      return "missing";
    case CellContent::kText:
      break;
  }
  return "text";
}

TEST(TextCellsTest, NumbersAreReadAsProgramsWriteThem) {
  EXPECT_EQ(read(" +1.5e3 "), "1500.000000");
  EXPECT_EQ(read("\"-0.25\""), "-0.250000");
  EXPECT_EQ(read("1.5D+03"), "1500.000000");
  EXPECT_EQ(read("-1.5d-01"), "-0.150000");
  EXPECT_EQ(read("1,5D+03", ','), "1500.000000");
  for (const char* text : {"D5", "1D", "1.5D+03D", "0x1F", "inf", "1.5 N", "1,5"}) {
    EXPECT_EQ(read(text), "text") << text;
  }
  for (const char* word : {"", "-", "--", "?", "NA", "n/a", "#N/A", "Null", "NaN", "None"}) {
    EXPECT_EQ(read(word), "missing") << word;
  }
  EXPECT_EQ(read(std::string(62, '0') + ".5"), "0.500000");
  EXPECT_EQ(read(std::string(63, '0') + ".5"), "text");
}

TEST(TextCellsTest, AStampIsReadInSeconds) {
  // 2026-11-26 is day 20783 since 1970-01-01 (date -u +%s -d 2026-11-26: 1795651200).
  EXPECT_EQ(read("2026-11-26T00:00:00Z"), "1795651200.000000");
  EXPECT_EQ(read("2026-11-26 00:00:01.250"), "1795651201.250000");
  EXPECT_EQ(read("2026-11-26T01:30:00+01:30"), "1795651200.000000");
  EXPECT_EQ(read("2026-11-25T19:00:00-0500"), "1795651200.000000");
  EXPECT_EQ(read("2026-11-26T00:00:00,5", ','), "1795651200.500000");
  EXPECT_EQ(read("00:00:01.5"), "1.500000");
  EXPECT_EQ(read("01:02"), "3720.000000");
  EXPECT_EQ(read("24:00"), "86400.000000");
  EXPECT_EQ(read("23:59:60.25"), "86400.250000");
  EXPECT_EQ(read("2026/11/26 01:00:00+01"), "1795651200.000000");
  EXPECT_EQ(read("20261126T010203"), "1795654923.000000");
  EXPECT_EQ(read("26.11.2026 00:00:01,5", ','), "1795651201.500000");
  for (const char* text : {"2026-02-30T00:00:00", "2026-11-26", "2026-11-26T", "25:00", "12:61:00",
                           "2026-11-26T00:00:00X", "1:2:3", "00:00:01.5.5", "12:60", "00:00:61",
                           "-1:00", "2026-11/26 00:00", "2026-11-26T0000", "00:00:00+1",
                           "00:00:00+010", "2026-11-1 00:00", "26.11,2026 00:00", "26.11.2026"}) {
    EXPECT_EQ(read(text), "text") << text;
  }
}

TEST(TextCellsTest, LinesAndCellsEndAtTheirSigns) {
  TextLines lines("a\r\nbc", 0, 7);
  TextLine line;
  EXPECT_TRUE(lines.next(line) && line.text == "a" && line.ended && line.number == 7 &&
              line.offset == 0);
  EXPECT_TRUE(lines.next(line) && line.text == "bc" && !line.ended && line.number == 8 &&
              line.offset == 3);
  EXPECT_FALSE(lines.next(line));
  std::vector<std::string_view> sut;
  split(" \ta  b\t", ' ', sut);
  EXPECT_EQ(sut, (std::vector<std::string_view>{"a", "b"}));
  split("a;\"b;c\";", ';', sut);
  EXPECT_EQ(sut, (std::vector<std::string_view>{"a", "\"b;c\"", ""}));
}

TEST(TextCellsTest, AQuoteEndsAfter40BytesBetweenCharacters) {
  const std::string most(40, 'x');
  EXPECT_EQ(in_quotes(most), "'" + most + "'");
  EXPECT_EQ(in_quotes(most + "\u00E9"), "'" + most + "...'");
  EXPECT_EQ(in_quotes(most.substr(1) + "\u00E9"), "'" + most.substr(1) + "...'");
}

}  // namespace stillhand::measurement::text_cells_test
