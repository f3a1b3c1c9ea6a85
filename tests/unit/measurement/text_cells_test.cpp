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
  for (const char* text : {"2026-02-30T00:00:00", "2026-11-26", "2026-11-26T", "25:00", "12:61:00",
                           "2026-11-26T00:00:00X", "1:2:3", "00:00:01.5.5"}) {
    EXPECT_EQ(read(text), "text") << text;
  }
}

}  // namespace stillhand::measurement::text_cells_test
